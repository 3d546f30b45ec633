"""Is the size of each effect that a diagnosis adds the same in all tests?  Right names and wrong.

Blind trials (`sysid trials`), chosen for their planters: what letting the size vary gains, in parts
of what the effect gained, and by how much the sizes differ.  An effect is refuted where both exceed
a half (`diagnosis/constancy.py`).
"""

import argparse
import os
from dataclasses import replace
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from outcome import Outcome

from sysid.diagnosis.bases import BASES, extendable, fit_bases, with_error_models
from sysid.diagnosis.constancy import varied_size
from sysid.diagnosis.extension import Extended, extend
from sysid.diagnosis.judged import round_of, with_verdicts
from sysid.rig.trial_campaign import make_trial
from sysid.trials.misfit import misfit_of
from sysid.trials.score import family_of
from sysid.trials.trial_id import parse_id, spec_of

TRIALS: Final = (
    "outside:50001", "outside:50012", "outside:50023", "outside:50034", "outside:50005",
    "one:30002", "one:30005", "one:30007", "one:30014", "one:30015", "one:30025", "one:30048",
    "one_misfit:40014", "one_misfit:40015", "one_misfit:40022", "one_misfit:40036",
    "one_misfit:40044",
)  # fmt: skip
EFFECTS: Final = 4
HEAD: Final = (
    "trial", "planted", "misfit", "effect", "right", "gain", "of varying", "ratio", "spread",
    "by", "asserted",
)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("trial", nargs="*", default=TRIALS, help="such as outside:50012")
    given = parser.parse_args()
    page = Outcome("constancy", "Is the size of an effect the same in all tests")
    rows = [row for name in given.trial for row in judged(name)]
    page.table(HEAD, [shown(row) for row in rows])
    page.say(
        "*Gain*: log-likelihood that the effect gained when it was added; *of varying*: that its",
        "size gains by varying, less what chance gains; *ratio*: of the two; *spread*: standard",
        "deviation of the sizes over their mean. Refuted from 0.5 in both.",
    )
    page.numbers["rows"] = rows
    page.finish(keep=tuple(given.trial) == TRIALS)


def judged(name: str) -> list[dict[str, Any]]:
    """One row for every effect that a diagnosis of a trial adds."""
    spec = spec_of(parse_id(name))
    misfit = misfit_of(spec.seed, spec.misfit, spec.design)
    design = replace(spec.design, misfit=misfit.size)
    trial = make_trial(spec.seed, spec.hidden, spec.percents or None, design)
    best = extended(trial.loops, trial.history, spec.seed)
    selection, truth = best.selection, trial.truth
    rows = []
    for k, (kind, one) in enumerate(zip(selection.kept, best.verdicts, strict=True)):
        varied = varied_size(best.base.evidence, selection.final, k)
        gain = round_of(selection, kind).contenders[0].gain
        kin = {family_of(cause) for cause in truth.causes} or set(truth.families)
        row = {
            "trial": name, "planted": ", ".join(spec.planters), "misfit": misfit.percent,
            "effect": kind, "right": family_of(kind) in kin, "gain": gain,
            "varying": varied.gained, "spread": varied.spread, "by": varied.quantity,
            "status": one.status or "nothing", "refuted": varied.refutes(gain),
        }  # fmt: skip
        print(" | ".join(shown(row)), flush=True)
        rows.append(row)
    return rows


def extended(loops: Any, history: Any, seed: int) -> Extended:
    """The best base with its effects, judged."""
    bases = fit_bases(loops, BASES, history=history, seed=seed, progress=_silent)
    bases = with_error_models(bases)
    every = [
        extend(b, EFFECTS, seed, _silent, coarse=False) for b in extendable(bases, coarse=False)
    ]
    best = min(every, key=lambda e: e.error)
    return with_verdicts(best, [e for e in every if e is not best])


def shown(row: dict[str, Any]) -> list[str]:
    """A row in words."""
    return [
        row["trial"], row["planted"], f"{row['misfit']:.0f} %", row["effect"],
        "yes" if row["right"] else "no", f"{row['gain']:.0f}", f"{row['varying']:.0f}",
        f"{row['varying'] / row['gain']:.2f}", f"{row['spread']:.2f}", row["by"] or "–",
        f"{row['status']}{', refuted' if row['refuted'] else ''}",
    ]  # fmt: skip


def _silent(_: str) -> None:
    """Nobody listens."""


if __name__ == "__main__":
    main()
