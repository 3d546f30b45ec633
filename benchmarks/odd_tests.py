"""A test that was recorded wrongly among sound ones: is it found, and what is said of it.

Campaigns of the blind trials, with their hidden effects and wrong laws.  First as they are: no test
is at odds with the others, and none should be called so.  Then one test of each, drawn by chance,
is given a slip: another gain of the force, a wrong zero, a late force, the current of another test.
"""

import argparse
import os
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from outcome import Outcome

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.data.loops import Loops
from sysid.errors import SysidError
from sysid.identification.at_odds import AtOdds, at_odds
from sysid.identification.fit import fit_loops
from sysid.rig.trial_campaign import make_trial
from sysid.trials.misfit import misfit_of
from sysid.trials.proportions import Share
from sysid.trials.regimes import REGIMES, plan
from sysid.trials.trial_id import first_seed

CHANCE: Final = 77
SHIPPED: Final = Path(__file__).parents[1] / "datasets" / "virtual-w11-low"
EXAMPLE: Final = "12.5mm_1.5Hz_0.2A"


@dataclass(frozen=True)
class Slip:
    """One way to spoil a test.

    Attributes:
        name: In words.
        clause: How the finding is recognised in what is said.
        spoil: (loops, place of the test, random numbers) → spoilt loops.
    """

    name: str
    clause: str
    spoil: Callable[[Loops, int, np.random.Generator], Loops]


def with_force(loops: Loops, k: int, force: np.ndarray) -> Loops:
    """The same loops, one with another force."""
    forces = loops.force.copy()
    forces[k] = force
    return replace(loops, force=forces)


def gain(loops: Loops, k: int, random: np.random.Generator) -> Loops:
    """A quarter more or a fifth less."""
    return with_force(loops, k, loops.force[k] * random.choice([0.8, 1.25]))


def zero(loops: Loops, k: int, random: np.random.Generator) -> Loops:
    """Up or down by a quarter of its largest force."""
    shift = 0.25 * random.choice([-1.0, 1.0]) * np.abs(loops.force[k]).max()
    return with_force(loops, k, loops.force[k] + shift)


def late(loops: Loops, k: int, random: np.random.Generator) -> Loops:
    """By a twentieth of the cycle."""
    return with_force(loops, k, np.roll(loops.force[k], loops.force.shape[1] // 20))


def current(loops: Loops, k: int, random: np.random.Generator) -> Loops:
    """Labelled with a current that is at least a quarter of the range away."""
    far = np.abs(loops.current - loops.current[k]) > 0.25 * np.ptp(loops.current)
    currents = loops.current.copy()
    currents[k] = random.choice(loops.current[far])
    return replace(loops, current=currents)


SLIPS: Final = (
    Slip("force × 0.8 or × 1.25", "times what they tell", gain),
    Slip("zero of the force off by a quarter of the peak", "N were", zero),
    Slip("force late by a twentieth of the cycle", "ms late", late),
    Slip("current of another test", "its current were", current),
)


@dataclass
class Tally:
    """What came of campaigns with one slip.

    Attributes:
        made: Campaigns.
        alone: The spoilt test, and no other, is named.
        beside: It is named, and another one, too.
        other: Only others are.
        told: The slip is among what it looks like, where the test is named.
        first: It stands first there.
    """

    made: int = 0
    alone: int = 0
    beside: int = 0
    other: int = 0
    told: int = 0
    first: int = 0


def main() -> None:
    given = arguments()
    alarms: dict[str, Counter] = {}
    tallies = {(slip.name, wrong): Tally() for slip in SLIPS for wrong in (False, True)}
    for regime in REGIMES:
        alarms[regime.name] = Counter()
        for spec in plan(regime.name, given.count, first_seed(regime.name)):
            try:
                size = misfit_of(spec.seed, spec.misfit, spec.design).size
                trial = make_trial(
                    spec.seed, spec.hidden, spec.percents or None, replace(spec.design, misfit=size)
                )
            except SysidError:
                continue
            found = odd_in(trial.loops)
            alarms[regime.name][found is not None] += 1
            if found is not None:
                print(regime.name, spec.seed, spec.planters, *found.words, flush=True)
            if regime.model == "w11":
                spoil(trial.loops, spec.seed, tallies, wrong=spec.misfit > 0.0)
    make_page(alarms, tallies).finish(keep=given.count >= 12)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=12, help="campaigns of each regime")
    return parser.parse_args()


def odd_in(loops: Loops) -> AtOdds | None:
    """Which tests the others contradict, by the base that a diagnosis tries first."""
    return at_odds(fit_loops(loops, variant="symmetric", weights="peak"), loops)


def spoil(loops: Loops, seed: int, tallies: dict[tuple[str, bool], Tally], *, wrong: bool) -> None:
    """Each slip in turn, in a test drawn by chance."""
    random = np.random.default_rng([seed, CHANCE])
    for slip in SLIPS:
        k = int(random.integers(len(loops.ids)))
        found, name = odd_in(slip.spoil(loops, k, random)), loops.ids[k]
        tally = tallies[slip.name, wrong]
        tally.made += 1
        if found is None:
            continue
        if name not in found.ids:
            tally.other += 1
            continue
        tally.alone += len(found.ids) == 1
        tally.beside += len(found.ids) > 1
        looks = found.tests[found.ids.index(name)].looks
        tally.told += any(slip.clause in words for words in looks)
        tally.first += bool(looks) and slip.clause in looks[0]


def example() -> str:
    """What is said of a shipped dataset, one test of which has half its force."""
    loops = cut_loops(load_campaign(SHIPPED).records, 360).loops
    k = loops.ids.index(EXAMPLE)
    found = odd_in(with_force(loops, k, 0.5 * loops.force[k]))
    return " ".join(found.words) if found else "nothing"


def make_page(alarms: dict[str, Counter], tallies: dict[tuple[str, bool], Tally]) -> Outcome:
    """False alarms by regime, findings by slip."""
    outcome = Outcome("odd_tests", "One wrongly recorded test among sound ones")
    outcome.say(
        "Campaigns of 60 to 110 loops of the blind trials, the symmetric generalised model fitted",
        "to each.  A test counts as at odds with the others by `sysid.identification.at_odds`.",
    )
    outcome.say("As they are, no test is wrong:")
    outcome.table(
        ("campaigns", "a test is called at odds"),
        [(name, share(n[True], n[True] + n[False])) for name, n in alarms.items()],
    )
    outcome.say("With one slip in one test, drawn by chance; laws right, or wrong by 2 or 5 %:")
    outcome.table(
        ("slip", "laws", "the test, and no other", "and another", "others only",
         "the slip is told, of these", "told first"),
        [
            (slip, "wrong" if wrong else "right", share(t.alone, t.made), t.beside, t.other,
             f"{t.told} of {t.alone + t.beside}", t.first)
            for (slip, wrong), t in tallies.items()
        ],
    )  # fmt: skip
    outcome.say(f"Of `datasets/virtual-w11-low` with half the force of {EXAMPLE} is said:")
    outcome.say(f"> {example()}")
    outcome.numbers["alarms"] = {n: [c[True], c[True] + c[False]] for n, c in alarms.items()}
    outcome.numbers["slips"] = [
        {"slip": slip, "laws_wrong": wrong, **vars(t)} for (slip, wrong), t in tallies.items()
    ]
    return outcome


def share(part: int, whole: int) -> str:
    """A count with Wilson's interval."""
    return str(Share(part, whole)) if whole else "–"


if __name__ == "__main__":
    main()
