"""Fit and diagnosis of the physical dampers, start to end, beside what is true of them.

``python benchmarks/physical_story.py`` writes results/physical_story.{md,json,png}.  ``--work DIR``
keeps what the commands wrote, and what is found there is not computed again.  ``--told`` computes
nothing and tells what is in that folder, without the diagnosis where that is not there yet.
"""

import argparse
import json
import shutil
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from outcome import Outcome
from physical_loops import loops_png
from physical_worth import worths

from sysid.cli.workers import prepare_to_diagnose
from sysid.rig.physical.mechanisms import ALWAYS

ROOT: Final = Path(__file__).resolve().parents[1]
RESULTS: Final = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Story:
    """A dataset, the model of the paper whose tests it repeats, and how it is diagnosed."""

    dataset: str
    model: str
    options: tuple[str, ...] = ()


STORIES: Final = (
    Story("virtual-matrix-165", "generalized"),
    Story("virtual-sweep", "lumped", ("--model", "lumped")),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, help="folder of the commands' results")
    parser.add_argument("--told", action="store_true", help="nothing computed")
    given = parser.parse_args()
    prepare_to_diagnose()
    with tempfile.TemporaryDirectory() as scratch:
        page = tell(given.work or Path(scratch), compute=not given.told)
    page.finish()


def tell(work: Path, *, compute: bool) -> Outcome:
    """The page, and its pictures."""
    page = Outcome("physical_story", "Fit and diagnosis of the physical dampers")
    page.say(
        "Two datasets of a damper that no model here matches (`docs/physical-damper.md`), fitted "
        "with the model of the paper whose tests they repeat and diagnosed. What is true of the "
        "damper is opened afterwards. Errors are mean RMSE/max|F| over tests."
    )
    for story in STORIES:
        folder = work / story.dataset
        if compute:
            _compute(story, folder)
        page.lines += ["", f"## {story.dataset}"]
        fit = json.loads((folder / "fit" / "fit.json").read_text())
        known = worths(story.dataset, folder / "worth.json", compute=compute)
        told, found = _fitted(story, fit, page), {"causes": [], "invisible": []}
        diagnosis = folder / "diagnosis"
        if (diagnosis / "diagnosis.json").is_file():
            found = json.loads((diagnosis / "diagnosis.json").read_text())
            told |= _answer(story, found, page)
            told["names"] = _names(found, known, page)
        told["mechanisms"] = _mechanisms(found, known, page)
        page.numbers[story.dataset] = told
        lines = folder / "fit" / "straight_lines.png"
        if lines.is_file():
            shutil.copyfile(lines, RESULTS / "physical_story_lines.png")
    picture = loops_png(work, [story.dataset for story in STORIES])
    (RESULTS / "physical_story.png").write_bytes(picture)
    return page


def _compute(story: Story, folder: Path) -> None:
    """`sysid fit` and `sysid diagnose`, where they have not been run yet."""
    from sysid.cli.app import run

    data = str(ROOT / "datasets" / story.dataset)
    fit = ["--model", story.model, "--no-posterior"]
    for command, options in (("fit", fit), ("diagnose", story.options)):
        out = folder / {"fit": "fit", "diagnose": "diagnosis"}[command]
        if out.is_dir():
            continue
        begin = time.perf_counter()
        code = run([command, data, "-o", str(out), "--quiet", *options])
        print(f"sysid {command} {story.dataset}: {time.perf_counter() - begin:.0f} s", flush=True)
        if code:
            raise SystemExit(code)


def _fitted(story: Story, fit: dict[str, Any], page: Outcome) -> dict[str, Any]:
    """What `sysid fit` says."""
    tests = [t for t in fit["tests"] if t["used"]]
    floor = sum(t["noise_floor_N"] * t["nrmse"] / t["rmse_N"] for t in tests) / len(tests)
    told = {
        "tests": len(tests),
        "fit_error": fit["summary"]["mean_nrmse"],
        "noise_floor": floor,
    }
    page.say(
        f"`sysid fit --model {story.model}` on {len(tests)} tests: {_percent(told['fit_error'])} "
        f"in sample, repeatability {_percent(floor)}."
    )
    return told | (_sweep(fit, page) if "static_force" in fit else {})


def _answer(story: Story, found: dict[str, Any], page: Outcome) -> dict[str, Any]:
    """What `sysid diagnose` says."""
    gain = found["gain"]
    told = {
        "answer": found["answer"],
        "base": found["base"]["held_out_nrmse"],
        "after": gain and gain["held_out_nrmse_after"],
        "sentences": found["sentences"],
        "because": found["unknown"]["because"],
        "invisible": [z["id"] for z in found["invisible"]],
    }
    page.say(
        f"`{' '.join(('sysid diagnose', *story.options))}`: answer `{told['answer']}`, every "
        f"condition predicted without it {_percent(told['base'])} with "
        f"the model alone, {_percent(told['after'])} with what was added. In its words:"
    )
    page.lines += ["", *(f"> {sentence}\n>" for sentence in told["sentences"])]
    page.say("Notes:", *found["notes"])
    page.say(f"Said to be invisible in these tests: {', '.join(told['invisible']) or 'nothing'}.")
    return told


def _sweep(fit: dict[str, Any], page: Outcome) -> dict[str, Any]:
    """What the fit of the lumped model tells besides."""
    static, laws = fit["static_force"], fit["temperature_laws"]
    lines = [line for line in fit["straight_lines"]["lines"] if line["symbol"].startswith("C_post")]
    told = {
        "fit_error_no_static": static["mean_nrmse_without"],
        "static_N_per_K": static["line"]["slope"],
        "bends": {law["symbol"]: law["curved"] for law in laws["bent"]},
    }
    slope = static["line"]["slope"]
    curved = [symbol for symbol, bends in told["bends"].items() if bends]
    page.say(
        "Of that error all but "
        f"{_percent(told['fit_error_no_static'])} is the static force of the gas, which the lumped "
        f"model does not have: the fit tells it, {slope['value']:.2f} ({slope['low']:.2f} … "
        f"{slope['high']:.2f}) N per kelvin. Laws that bend over temperature on tests left out: "
        f"{', '.join(curved) or 'none'}. Straight lines of C_post were laid at {len(lines)} "
        "currents. In the damper the viscosity follows Arrhenius and the yield stress a line."
    )
    return told


def _names(
    found: dict[str, Any], known: list[dict[str, Any]], page: Outcome
) -> list[dict[str, Any]]:
    """What was asserted, and what of the damper or its rig it is."""
    told = []
    for cause in found["causes"]:
        members = cause["class"]
        true = [f"{m['name']} ({_percent(m['of_force'])})" for m in known if _meant(m, members)]
        true += [ALWAYS[name] for name in members if name in ALWAYS]
        told.append(
            {
                "said": members if cause["id"] else [f"family {cause['family']}"],
                "status": cause["status"],
                "confidence": cause["confidence"],
                "parameters": cause["parameters"],
                "is": true,
            }
        )
    page.say(
        "What was asserted, beside what there is of that kind (in parentheses what it is worth, "
        "see below):"
    )
    page.table(
        ["said", "as", "confidence", "value, 95 % interval", "there is"],
        [
            [", ".join(t["said"]), t["status"], f"{t['confidence']:.2f}", _values(t["parameters"]),
             "; ".join(t["is"]) or "nothing of that name"]
            for t in told
        ],
    )  # fmt: skip
    return told


def _meant(mechanism: dict[str, Any], members: list[str]) -> bool:
    return bool(set(mechanism["causes"]) & set(members))


def _values(parameters: dict[str, Any]) -> str:
    def end(value: float | None) -> str:
        return "?" if value is None else f"{value:.3g}"

    return "; ".join(
        f"{symbol} = {end(q['value'])} ({end(q['low'])} … {end(q['high'])}) {q['unit']}"
        for symbol, q in parameters.items()
    )


def _mechanisms(
    found: dict[str, Any], known: list[dict[str, Any]], page: Outcome
) -> list[dict[str, Any]]:
    """Every mechanism, what it is worth, and what the diagnosis says of it."""
    said = [name for cause in found["causes"] for name in cause["class"]]
    hidden = [z["id"] for z in found["invisible"]]
    told = []
    for m in known:
        asserted = [name for name in said if name in m["causes"]]
        unseen = [name for name in hidden if name in m["causes"]]
        how = "not told"
        if asserted:
            how = f"asserted: {', '.join(asserted)}"
        elif unseen:
            how = f"cannot be seen: {', '.join(unseen)}"
        told.append(m | {"said": how})
    if told:
        page.say(
            "What is true: each mechanism taken out and everything else kept. Change of the force "
            "in steady cycles, RMS, of the RMS force: over all tests, and in the test where it is "
            "largest."
        )
        page.table(
            ["mechanism", "", "all tests", "most", "diagnosis"],
            [
                [m["name"], m["about"], _percent(m["of_force"]),
                 f"{_percent(m['most'])} ({m['where']})", m["said"]]
                for m in told
            ],
        )  # fmt: skip
    return told


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.2g} %"


if __name__ == "__main__":
    main()
