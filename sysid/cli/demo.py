"""`sysid demo`: something is hidden in the tests of a virtual damper, and looked for."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from sysid.cli.console import Talk
from sysid.cli.options import Json, Quiet
from sysid.errors import OutputError

if TYPE_CHECKING:
    from sysid.cli.diagnosed import Diagnosed
    from sysid.rig.trial_design import TrialDesign

HIDDEN: Final = (
    "rod_play", "soft_mount", "large_gas_chamber", "gas_pocket", "stiff_seal", "side_load",
    "gas_preload", "bent_load_cell", "oil_column", "scratched_wall",
)  # fmt: skip
"""What `--seed` chooses from, in turn; the last one is in no catalogue."""
PERCENT: Final = 3.0
"""Of the RMS force."""
_DAMPER: Final = 3
"""Seed of the damper, the choice of tests and the errors of the rig with `--seed 0`."""


def design() -> "TrialDesign":
    """Twenty-four tests of four cycles, so that all is done within a minute."""
    from sysid.rig.trial_design import TrialDesign

    return TrialDesign(fewest=24, most=24, points=120, cycles=4)


def demo(
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR", help="Folder for the tests and the results."),
    ] = Path("sysid-demo"),
    json: Json = False,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Another damper, with something else hidden.")
    ] = 0,
    quiet: Quiet = False,
) -> None:
    """The whole story in a minute: hide an effect in virtual tests, diagnose them, open the seal.

    Writes raw tests with a sealed truth (DIR/tests), and what a diagnosis of them writes
    (DIR/diagnosis): report.html, the extended card.json, figures.
    """
    talk = Talk(json, quiet)

    from sysid.cli.compile_cache import keep_compiled
    from sysid.data.whole_file import need_writable, write_files
    from sysid.rig.planters.registry import find_planter
    from sysid.rig.trial_campaign import make_trial
    from sysid.trials.raw_tests import raw_tests

    tests, results = output / "tests", output / "diagnosis"
    _need_new(tests)
    need_writable(results)
    keep_compiled(talk, many=True)
    with talk.progress("Testing a virtual damper"):
        planter = find_planter(HIDDEN[seed % len(HIDDEN)])
        trial = make_trial(_DAMPER + seed, (planter,), (PERCENT,), design())
        write_files(raw_tests(trial, "Virtual damper of sysid demo", _DAMPER + seed), tests)
    talk.say(
        f"{tests}: {len(trial.loops.ids)} tests of a virtual damper. Something is hidden in them, "
        f"{PERCENT:g} % of the force; what, is sealed in sealed/truth.json.\n"
    )
    found = _diagnose(talk, tests, results)
    hidden = _opened(tests)
    talk.say(
        f"\nThe seal is opened. Hidden was: {hidden['planter']}"
        f" ({', '.join(hidden['causes']) or 'in no catalogue'}), {_size(hidden)}."
        f"\n\nLook at {results / 'report.html'}. Then try it on your own folder of tests:"
        "\n  sysid check FOLDER\n  sysid diagnose FOLDER -o results"
        f"\nor hide something else: sysid demo --seed {seed + 1} -o another"
    )
    talk.result({"tests": str(tests), "hidden": hidden, "diagnosis": found.summary})
    if found.distrust:
        talk.distrust(found.distrust)
        raise typer.Exit(3)


def _need_new(tests: Path) -> None:
    """Raw tests are never overwritten."""
    if tests.exists() and any(tests.iterdir()):
        raise OutputError(
            "holds files already; a demonstration overwrites no tests",
            where=tests,
            advice=f"Remove {tests.parent}, or give another folder with -o",
        )


def _diagnose(talk: Talk, tests: Path, results: Path) -> "Diagnosed":
    """Diagnose the folder as `sysid diagnose` does, on one base and for one effect."""
    from sysid.cli.diagnosed import diagnosed
    from sysid.cli.diagnosis_tables import show_diagnosis
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.data.whole_file import write_files

    loaded = load_campaign(tests, None, flip_force=False)
    chosen = select(loaded, (), ())
    with talk.progress("Diagnosing the tests") as progress:
        result = diagnosed(
            loaded, chosen, models=[("generalized", None)], max_effects=1, seed=0,
            command=f"sysid diagnose {tests} --model generalized --max-effects 1 -o {results}",
            output=results, progress=progress,
        )  # fmt: skip
    write_files(result.files, results)
    show_diagnosis(talk, result)
    return result


def _opened(tests: Path) -> dict[str, Any]:
    """What the seal says was hidden."""
    from sysid.rig.truth import SEAL_FILE, open_seal

    (effect,) = open_seal(tests / SEAL_FILE).effects
    return dict(effect)


def _size(hidden: dict[str, Any]) -> str:
    """Quantities of a hidden effect, SI, with the unit that the catalogue has for its size."""
    from sysid.effects.registry import effect_kind
    from sysid.parameters import specs

    units = {
        spec.symbol: spec.unit for cause in hidden["causes"] for spec in specs(effect_kind(cause))
    }
    sizes = [effect_kind(cause).facts.size for cause in hidden["causes"]]
    unit = f" {units[sizes[0]]}" if sizes else " in SI units"
    return ", ".join(
        f"{name} {value:.3g}{unit if name == 'size' else ''}"
        for name, value in hidden["quantities"].items()
    )
