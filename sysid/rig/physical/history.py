"""What a test inherits from those before it: temperature, iron that remembers, a worn seal."""

from collections.abc import Mapping, Sequence

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Float

from sysid.rig.chance import Stream
from sysid.rig.excitation import SineRun
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.heat import HeatBalance
from sysid.rig.physical.magnet import after_history, field_yield_stress
from sysid.rig.physical.warming import Operator

PerTest = Float[np.ndarray, " test"]
"""In the order of the design."""


def run_order(wanted: PerTest, stream: Stream) -> list[int]:
    """Places in the design, in the order of running: cold tests first, else by chance.

    Args:
        wanted: Temperature of each test, °C.
        stream: Of random numbers.
    """
    rank = stream.order(len(wanted)).tolist()
    return sorted(range(len(wanted)), key=lambda k: (wanted[k], rank[k]))


def temperatures(
    operator: Operator, heat: HeatBalance, wanted: PerTest, order: list[int], stream: Stream
) -> tuple[PerTest, PerTest]:
    """Oil and body at the start of each test, °C.

    Args:
        operator: What happens between tests.
        heat: Balance of oil and body.
        wanted: Temperature of each test, °C.
        order: Of running.
        stream: Of random numbers.
    """
    oils, bodies = np.empty(len(order)), np.empty(len(order))
    oil = body = float(heat.room)
    for k in order:
        away = operator.scatter * stream.one_normal()
        target = float(wanted[k]) + max(-operator.window, min(operator.window, away))
        oil, body = operator.bring(heat, oil, body, target)
        oils[k], bodies[k] = oil, body
    return oils, bodies


def yield_stresses(damper: PhysicalDamper, currents: PerTest, order: list[int]) -> PerTest:
    """Of each test at 40 °C, Pa: the iron remembers the two tests before; between, 0 A.

    Args:
        damper: With its magnet.
        currents: A.
        order: Of running.
    """
    current = currents[order]
    before = np.concatenate([[0.0, 0.0], current])
    none = np.zeros_like(current)
    ways = np.stack([before[:-2], none, before[1:-1], none, current])
    gap, solids = float(damper.valve.gap), float(damper.oil.solids)
    stress = np.empty_like(current)
    stress[order] = field_yield_stress(after_history(damper.magnet, gap, solids, ways), solids)
    return stress


def slid_before(runs: Sequence[SineRun], order: list[int]) -> PerTest:
    """M that the seal has slid before each test."""
    own = np.array([4.0 * r.amplitude * (r.steady + 0.5 * (r.ramp_up + r.ramp_down)) for r in runs])
    ways = np.empty(len(runs))
    ways[order] = np.cumsum(own[order]) - own[order]
    return ways


def worn(damper: PhysicalDamper, ways: PerTest) -> PhysicalDamper:
    """The damper as each test finds it: every constant has one value for each.

    Args:
        damper: As new.
        ways: M that the seal has slid before each test.
    """
    count = len(ways)
    each = jax.tree.map(lambda leaf: np.full(count, float(leaf)), damper)
    wear = damper.wear
    seal, gas = np.exp(-float(wear.seal) * ways), np.exp(-float(wear.gas) * ways)
    creep = np.exp(float(wear.creep) * ways)
    return _scaled(each, {("seal", "sliding"): seal, ("seal", "breakaway"): seal,
                          ("gas", "charge"): gas, ("valve", "creep"): creep})  # fmt: skip


def _scaled(
    damper: PhysicalDamper, factors: Mapping[tuple[str, str], np.ndarray]
) -> PhysicalDamper:
    for (part, name), factor in factors.items():
        value = getattr(getattr(damper, part), name) * factor
        damper = eqx.tree_at(lambda d, p=part, n=name: getattr(getattr(d, p), n), damper, value)
    return damper
