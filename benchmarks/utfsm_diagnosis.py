"""The diagnosis of the measured UTFSM damper: what is missing, and what it is worth held out."""

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from outcome import Outcome

if TYPE_CHECKING:
    from sysid.diagnosis.result import Diagnosis

ROOT: Final = Path(__file__).resolve().parents[1]
DATA: Final = ROOT.parent / "shared" / "data" / "utfsm"
MANIFEST: Final = ROOT / "datasets" / "utfsm" / "campaign.toml"
TARGET: Final = 0.04


def main() -> None:
    from utfsm_limits import limits

    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.diagnosis.bases import BASES, LAST_RESORT, fit_bases
    from sysid.diagnosis.diagnose import diagnose_loops
    from sysid.report.before_after_plot import before_after_png

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=DATA, help=f"default {DATA}")
    parser.add_argument("--model", default="carreau", help="base, or all for the usual ones")
    parser.add_argument("--effects", type=int, default=5, help="added at most")
    parser.add_argument("--quick", action="store_true", help="nothing written")
    given = parser.parse_args()
    if not given.folder.is_dir():
        print(
            f"Skipped: {given.folder} is not here; datasets/utfsm/README.md says where to get it."
        )
        return
    loops = select(load_campaign(given.folder, MANIFEST), (), ()).loops
    models = None if given.model == "all" else ((given.model, None),)
    begin = time.perf_counter()
    found = diagnose_loops(
        loops, models=models, max_effects=given.effects,
        progress=lambda line: print(f"{time.perf_counter() - begin:6.0f} s  {line}", flush=True),
    )  # fmt: skip
    seconds = time.perf_counter() - begin
    others = fit_bases(loops, (*BASES, *LAST_RESORT), seed=0, progress=print)
    outcome = page(
        found, [(b.fit.model, b.fit.variant, b.error) for b in others], list(limits(found))
    )
    outcome.numbers["seconds"] = seconds
    outcome.finish(keep=not given.quick)
    if not given.quick:
        figure = Path(__file__).parent / "results" / "utfsm_diagnosis.png"
        figure.write_bytes(before_after_png(found))


def page(
    found: "Diagnosis", bases: list[tuple[str, str, float]], free: list[tuple[str, float, float]]
) -> Outcome:
    """What was found, as a page; the held-out error of every base alone; and what limits it."""
    outcome = Outcome("utfsm_diagnosis", "Diagnosis of the UTFSM measurements")
    outcome.say(f"Answer: {found.answer}.")
    for sentence in found.sentences:
        outcome.say(sentence)
    outcome.table(
        ("base alone", "held out"),
        [(f"{model}, {variant}", _percent(error)) for model, variant, error in bases],
    )
    if found.gain is not None:
        gain = found.gain
        outcome.table(
            ("test", "before, held out", "after, held out"),
            [
                (name, _percent(b), _percent(a))
                for name, b, a in zip(
                    gain.held_out, gain.per_test_before, gain.per_test_after, strict=True
                )
            ],
        )
        outcome.say(
            f"Mean {_percent(gain.before)} before, {_percent(gain.after)} after (half of before, "
            f"and {_percent(TARGET)}, are the targets); repeatability "
            f"{_percent(gain.repeatability)}."
        )
    outcome.say(
        "What limits it: errors where parts of the extended model are given more freedom than any "
        "law has. Parameters that are free for every test or condition predict nothing; their "
        "error in sample bounds what a better law for that part could reach."
    )
    outcome.table(
        ("left free", "in sample", "held out"),
        [(words, _percent(known), _percent(unseen)) for words, known, unseen in free],
    )
    outcome.numbers = {
        "limits": [
            (words, known, unseen if np.isfinite(unseen) else None) for words, known, unseen in free
        ],
        "answer": found.answer,
        "sentences": found.sentences,
        "bases": bases,
        "before": found.gain and found.gain.before,
        "after": found.gain and found.gain.after,
        "effects": [e.facts.id for e in found.damper.effects],
    }
    return outcome


def _percent(value: float) -> str:
    return f"{100 * value:.1f} %" if np.isfinite(value) else "–"


if __name__ == "__main__":
    main()
