"""How often the spring's equation stays unsolved where friction behind it falls with speed.

Random dampers with effects of sizes that the catalogue calls realistic, simulated on steady loops.
A loop counts as unsolved where its force differs by more than `SOLVED` from what damper and
friction have at the motion that this force leaves them.  Friction that falls with speed sticks and
slips behind a spring: more than one force may solve the equation, or none near the last one.
"""

from collections.abc import Callable
from typing import Any, Final

import equinox as eqx
import numpy as np
from outcome import Outcome, arguments

from sysid.effects.backward_differences import differences_of
from sysid.effects.base import AbstractEffect
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.effects.motion.series_compliance import FINEST, SeriesCompliance
from sysid.effects.series_spring import Setting, series_force
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import build

SOLVED: Final = 1e-6
"""Parts of max|F|."""
TESTS: Final = tuple(
    (a, f, i)
    for a in (0.0025, 0.005, 0.0125, 0.025)
    for f in (0.25, 1.0, 2.5)
    for i in (0.0, 0.2, 0.4)
)
"""Amplitude m, frequency Hz, current A."""
LAWS: Final = {"as published": 1.0, "a fifth as steep": 0.2}
"""Factors on a_0, the steepness of W11's loop at low speed."""


def main() -> None:
    dampers, quick = arguments(__doc__ or "", 60, 5)
    page = Outcome("unsolved_springs", "Springs with falling friction behind them")
    page.say(
        f"{dampers} dampers a row, {len(TESTS)} tests each, at {FINEST} points a cycle: W11's",
        "symmetric damper behind a spring, and friction of random size within the realistic range",
        f"of the catalogue. Unsolved: an equation is left open by more than {SOLVED:g} of max|F|.",
    )
    head = ("steepness", "friction", "loops", "unsolved", "share, %", "worst, % of max|F|")
    page.table(head, [row(name, kind, dampers, page) for name in LAWS for kind in FRICTION])
    page.finish(keep=not quick)


def row(laws: str, friction: str, dampers: int, page: Outcome) -> tuple[Any, ...]:
    """One row of the table; its numbers are added to the page."""
    rng = np.random.default_rng(5)
    steep = LOW_SYMMETRIC["a_0"] * LAWS[laws]
    valve = build(Generalized, LOW_SYMMETRIC | {"a_0": steep})
    motion = sine_motion(*np.array(TESTS).T, points=FINEST)
    left = np.concatenate(
        [
            np.asarray(left_open(Damper(valve, FRICTION[friction](rng)), compliance, motion))
            for compliance in drawn(rng, dampers, *SeriesCompliance.facts.realistic["s_k"])
        ]
    )
    unsolved = int(np.sum(left > SOLVED))
    page.numbers[f"{laws}, {friction}"] = {
        "loops": left.size, "unsolved": unsolved, "worst": float(left.max()),
    }  # fmt: skip
    share, worst = 100.0 * unsolved / left.size, 100.0 * float(left.max())
    return laws, friction, left.size, unsolved, f"{share:.2g}", f"{worst:.2g}"


@eqx.filter_jit
def left_open(damper: Damper, compliance: Any, motion: Motion) -> Any:
    """Largest |Φ(x − s F, v − s Ḟ, a − s F̈) − F| over max|F|, [L].

    Args:
        damper: Φ, behind the spring.
        compliance: s, m/N.
        motion: Ahead of the spring, L tests.
    """
    setting = Setting(
        motion.displacement, motion.velocity, motion.acceleration, compliance,
        differences_of(motion), motion.periodic,
    )  # fmt: skip
    place, force = series_force(lambda x, w, a: (w, damper.force(motion.moved(x, w, a))), setting)
    behind = damper.force(motion.moved(place, *setting.behind(force)))
    return abs(behind - force).max(axis=-1) / abs(force).max(axis=-1)


def drawn(rng: np.random.Generator, count: int, low: float, high: float) -> np.ndarray:
    """Sizes between two, evenly over their logarithm."""
    return np.exp(rng.uniform(np.log(low), np.log(high), count))


def of_size(kind: type[AbstractEffect], rng: np.random.Generator) -> AbstractEffect:
    """An effect with all its parameters drawn within what is realistic."""
    ranges = kind.facts.realistic
    return kind(**{name: float(drawn(rng, 1, *ends)[0]) for name, ends in ranges.items()})


FRICTION: Final[dict[str, Callable[[np.random.Generator], tuple[AbstractEffect, ...]]]] = {
    "none": lambda _: (),
    "presliding": lambda rng: (of_size(PreslidingFriction, rng),),
    "Stribeck": lambda rng: (of_size(StribeckFriction, rng),),
}


if __name__ == "__main__":
    main()
