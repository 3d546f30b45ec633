"""What phase points leave of a hidden effect: recorded loops and models against the fine physics.

A recorded loop of a trial is the mean over phase bins, as in loops that are cut from records; a
model is simulated at phase points.  What is shorter than a point, a play of 20 µm say, is blurred
by the first and folded into other harmonics by the second.
"""

from collections.abc import Sequence
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
from outcome import Outcome, arguments

from sysid.effects.base import AbstractEffect
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.effects.motion.backlash import Backlash
from sysid.likelihood.compress import harmonic_basis
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.rig.planters.backlash import LoosePin, RodPlay
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.rod_friction import BreakawaySeal
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import STANDARD

FIRST_SEED = 900_400
FINE, COARSE, BETWEEN = 720, 72, 360
PLANTERS: tuple[Planter, ...] = (RodPlay(), LoosePin(), BreakawaySeal())
PERCENT = 1.0


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 6, 1)
    page = Outcome("trial_sampling", "What phase points leave of a hidden effect")
    rows, numbers = [], {}
    for planter in PLANTERS:
        found = np.array([errors(planter, FIRST_SEED + k) for k in range(campaigns)])
        median = np.median(found, axis=0)
        numbers[planter.name] = dict(zip(NAMES, median.tolist(), strict=True))
        rows.append([planter.name, *(f"{v:.2g}" for v in median)])
    page.say(
        f"{campaigns} campaigns a row, correct base, true parameters, nothing fitted, no errors of",
        "the rig, no noise.  RMS over a campaign of what differs in harmonics 0 to 15, N, medians;",
        f"the hidden effect is {PERCENT:g} % of the RMS force.",
    )
    page.table(["hidden", *NAMES], rows)
    page.say(
        "Where a model is off by as much as the effect itself, a play comes out too large or too",
        "small, and what is left of it looks like inertia or friction.",
    )
    page.numbers = numbers
    page.finish(keep=not quick)


NAMES = (
    "effect", "72 recorded bins", "360 recorded bins",
    "catalogue's formula on 72 points", "on 360 points",
)  # fmt: skip


def errors(planter: Planter, seed: int) -> tuple[float, ...]:
    """The effect, and by how much recorded loops and models are off, N (`NAMES`)."""
    trials = {
        points: make_trial(seed, (planter,), (PERCENT,), replace(STANDARD, points=points))
        for points in (COARSE, BETWEEN, FINE)
    }
    true = harmonics(trials[FINE].truth.force)
    without = harmonics(trials[FINE].truth.force_without)
    recorded = (harmonics(trials[points].truth.force) for points in (COARSE, BETWEEN))
    models = (model(trials[points]) for points in (COARSE, BETWEEN))
    return (size(true - without), *(size(z - true) for z in (*recorded, *models)))


def model(trial: Trial) -> np.ndarray:
    """The right base with the catalogue's effect at the planted values, in harmonics."""
    valve = build(Generalized, trial.truth.parameters)
    damper = Damper(valve, (effect_of(trial.truth.planters),))
    return harmonics(np.asarray(simulate(damper, loop_motion(trial.loops))))


def effect_of(planters: Sequence[Planter]) -> AbstractEffect:
    """The catalogue's effect at the values of a planter."""
    (planter,) = planters
    if isinstance(planter, BreakawaySeal):
        return StribeckFriction(
            F_s=jnp.asarray(planter.size),
            v_st=jnp.asarray(planter.film_speed),
            sigma_0=jnp.asarray(planter.stiffness),
        )
    joint = "loose" if isinstance(planter, LoosePin) else "held"
    return Backlash(delta=jnp.asarray(planter.size), joint=joint)


def harmonics(loops: np.ndarray) -> np.ndarray:
    return harmonic_basis(loops.shape[1]).compress(loops)


def size(difference: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum(difference**2, axis=1))))


if __name__ == "__main__":
    main()
