"""What could be told at best of a raised mechanism of the physical damper.

The damper as built is fitted with the base that trials on it (`physical_trials.py`) end with and
the effects that pay there.  Then each mechanism is raised as in a trial.  Of the change of the
force a refit of that model takes up a part; of the rest a part goes with the catalogue's formula of
its cause.  That part is all that can speak for the name, beside what the model leaves anyway: with
q independent numbers a test,

    ΔlnL = q L/2 · ln(1 + (part/left)²)

is gained by it, and a name needs `LEAST_GAIN`.
"""

import argparse
import json
import os
from collections import Counter
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from outcome import RESULTS, Outcome
from work_file import read_rows

from sysid.cli.soundness import unfit
from sysid.data.loops import Loops
from sysid.diagnosis.absorbed import products
from sysid.diagnosis.bases import fit_bases
from sysid.diagnosis.coarse import select_coarsely
from sysid.diagnosis.contenders import LEAST_GAIN
from sysid.diagnosis.diagnose import MOST
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import INDEPENDENT, UNIT, plainly_fitted, unweighted
from sysid.diagnosis.prototypes import prototypes, shape_grid
from sysid.diagnosis.scores import INVISIBLE
from sysid.diagnosis.signatures import signatures
from sysid.diagnosis.state import State
from sysid.models.coordinates import valve_at
from sysid.motion.history import RunHistory
from sysid.rig.physical.mechanisms import Mechanism
from sysid.trials.physical import RAISED, campaign_of, tests_of
from sysid.trials.trial_id import FIRST_SEED, LEVEL, PHYSICAL

NAME = "physical_bound"
BASE = (("generalized", "symmetric"),)


@dataclass(frozen=True)
class Model:
    """The damper as built, as a diagnosis far from any base models it.

    Attributes:
        evidence: The campaign, `unweighted`.
        state: The fit.
        owners: k ids of the catalogue, once for each shape.
        signatures: [L, m, k] of these, N per unit of the size.
    """

    evidence: Evidence
    state: State
    owners: tuple[str, ...]
    signatures: Float[np.ndarray, "loop m k"]

    def percent(self, energy: float) -> float:
        """Quadratic mean over tests in % of max|F| of what has an energy under 1/max|F|."""
        return 100.0 * UNIT * float(np.sqrt(max(energy, 0.0) / self.evidence.tests))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=FIRST_SEED[PHYSICAL], help="of the campaign")
    parser.add_argument("--quick", action="store_true", help="one mechanism, nothing written")
    parser.add_argument("--page", action="store_true", help="make the page of what is done")
    given = parser.parse_args()
    if given.page:
        report(json.loads((RESULTS / f"{NAME}.json").read_text("utf-8"))).finish()
        return
    loops, history = tests_of(campaign_of(given.seed, {}), unfit)
    model = modelled(loops, history, given.seed)
    residual = model.state.gls.residual
    left = model.percent(model.evidence.energy(residual) / UNIT**2)
    rows = []
    for one in RAISED[: 1 if given.quick else None]:
        rows.append(row_of(model, loops, given.seed, one, left))
        print(rows[-1], flush=True)
    numbers = {"seed": given.seed, "tests": len(loops.ids), "effects": list(model.state.ids),
               "left_percent": left, "mechanisms": rows}  # fmt: skip
    report(numbers).finish(keep=not given.quick)


def report(found: dict[str, Any]) -> Outcome:
    """Page and numbers."""
    page = Outcome(NAME, "What physical trials could tell at best", numbers=dict(found))
    page.numbers.pop("machine", None)
    page.say(
        f"{found['tests']} tests of campaign {found['seed']} as built, generalized symmetric with "
        f"{', '.join(found['effects'])}, which leaves {found['left_percent']:.2f} % of max|F| "
        f"(quadratic mean). Each mechanism is raised to {LEVEL:g} times its level; all to first "
        "order. At its level: a cause of it is in most answers to trials that raise nothing "
        "([trials](physical_trials.md)), as a name or in a class."
    )
    rows = sorted(found["mechanisms"], key=lambda r: (-r["gain"], r["mechanism"]))
    usual = usually_answered()
    causes = {one.name: set(one.causes) for one in RAISED}
    there = [r["mechanism"] for r in rows if causes[r["mechanism"]] & usual]
    more = [
        r["mechanism"] for r in rows
        if r["gain"] >= LEAST_GAIN and r["mechanism"] not in there
    ]  # fmt: skip
    told = dict.fromkeys(there, "at its level") | dict.fromkeys(more, "can be")
    page.table(
        ["raised", "changes the force by, %", "a refit leaves, %", "like its own cause (cosine)",
         "like another", "ΔlnL of its own cause", "told"],
        [
            [r["mechanism"], f"{r['change']:.2g}", f"{r['rest']:.2g}",
             "none that loops show" if r["own"] is None else f"{r['own']:.2f}",
             f"{r['rival']} {r['likeness']:.2f}", f"{r['gain']:.2g}",
             told.get(r["mechanism"], "no")]
            for r in rows
        ],
    )  # fmt: skip
    page.say(
        f"Of {len(rows)} mechanisms {len(there)} are told at their own level, raised or not, and "
        f"{len(more)} more could gain the {LEAST_GAIN:g} that a name needs: "
        f"{len(there) + len(more)} of {len(rows)} at best."
    )
    page.numbers |= {"at_level": there, "can_be": more, "least_gain": LEAST_GAIN}
    return page


def usually_answered() -> set[str]:
    """Causes in most answers to trials that raise nothing."""
    every = [row for row in read_rows(RESULTS / "physical_trials.jsonl") if not row["planters"]]
    count = Counter(
        cause
        for row in every
        for cause in {m for j in row["score"]["judged"] for m in j["given"]["members"]}
    )
    return {cause for cause, times in count.items() if 2 * times > len(every)}


def modelled(loops: Loops, history: RunHistory | None, seed: int) -> Model:
    """Fit the base and add what pays, as a diagnosis does."""
    base = fit_bases(loops, BASE, history=history, seed=seed, progress=print)[0]
    evidence = unweighted(base.evidence)
    chosen = select_coarsely(evidence, base.free, most=MOST, progress=print).final
    state = plainly_fitted(evidence, chosen.coordinates, chosen.u)
    shapes = [s for e in prototypes(evidence.size) for s in shape_grid(e, evidence.size)]
    valve = valve_at(state.coordinates, jnp.asarray(state.u)).valve
    columns = signatures(evidence, valve, shapes)
    return Model(evidence, state, tuple(s.facts.id for s in shapes), columns)


def row_of(model: Model, loops: Loops, seed: int, one: Mechanism, left: float) -> dict[str, Any]:
    """A mechanism raised, and what could be told of it.

    Args:
        model: Of the damper as built.
        loops: Its tests.
        seed: Of the campaign.
        one: The mechanism.
        left: What the model leaves, % of max|F|.
    """
    raised, _ = tests_of(campaign_of(seed, {one.name: LEVEL}), unfit)
    change = np.zeros_like(loops.force)
    for k, name in enumerate(loops.ids):
        if name in raised.ids:
            change[k] = raised.force[raised.ids.index(name)] - loops.force[k]
    planted = model.evidence.basis.compress(change)[:, :, None]
    both = np.concatenate([planted, model.signatures], axis=2)
    before, after = products(both, model.state.gls.jacobian, model.state.covariance)
    whole, rest = np.diagonal(before), np.maximum(np.diagonal(after), 0.0)
    seen = rest[1:] > INVISIBLE * whole[1:]
    lengths = np.where(seen, np.sqrt(rest[0] * rest[1:]), np.inf)
    cosines = np.abs(after[0, 1:]) / lengths
    mine = np.array([owner in one.causes for owner in model.owners], dtype=bool)
    own = float(cosines[mine].max()) if mine.any() else None
    nearest = int(np.argmax(np.where(mine, -1.0, cosines)))
    part = model.percent(rest[0]) * (own or 0.0)
    gain = 0.5 * INDEPENDENT * model.evidence.tests * float(np.log1p((part / left) ** 2))
    return {
        "mechanism": one.name, "change": model.percent(whole[0]), "rest": model.percent(rest[0]),
        "own": own, "rival": model.owners[nearest], "likeness": float(cosines[nearest]),
        "gain": gain,
    }  # fmt: skip


if __name__ == "__main__":
    main()
