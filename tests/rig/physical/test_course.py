"""Whole tests of the physical damper in limits that have closed forms, and its energy."""

from dataclasses import replace
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp, trapezoid
from scipy.interpolate import CubicSpline
from scipy.optimize import root_scalar

from sysid.rig.excitation import SineRun
from sysid.rig.physical.automotive import AUTOMOTIVE
from sysid.rig.physical.course import Courses, Outset, run_tests
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.equations import Drive, at_rest, balance
from sysid.rig.physical.gas import ATMOSPHERE
from sysid.rig.physical.rd1005 import RD_1005

POINTS = 400
AMPLITUDE, FREQUENCY = 10e-3, 4.0
RUN = SineRun(AMPLITUDE, FREQUENCY, 0.0, (), 0.05, 0.5, 2.0, 0.5)
FAST = replace(RUN, amplitude=2.5e-3, frequency=10.0)
"""Of the lane "reference"."""
YIELD = 17e3
"""Pa; at about 0.4 A."""


def _changed(damper: PhysicalDamper, **values: float) -> PhysicalDamper:
    """A damper with other constants, named part__constant."""
    for name, value in values.items():
        part, constant = name.split("__")
        damper = eqx.tree_at(lambda d, p=part, c=constant: getattr(getattr(d, p), c), damper, value)
    return damper


RIGID = _changed(
    RD_1005, rig__mount=1e11, rig__column=1e11, rig__play=0.0, rig__servo=1e4,
    oil__expansion=0.0, mixing__release=0.0, heat__oil=1e9, heat__body=1e9,
)  # fmt: skip
INCOMPRESSIBLE = _changed(RIGID, oil__bulk_modulus=1e14, oil__air=1e-9, oil__density=1e-3)
"""Without inertia too, which would take the derivative of a speed that the steps do not follow."""
ODD = _changed(
    RIGID, oil__bulk_modulus=1.5e9 / 33e-6, oil__air=0.0, cylinder__far=1.0, cylinder__near=1.0,
    cylinder__rod=1e-12, seal__per_pressure=0.0,
)  # fmt: skip
"""Volumes so large that the stroke does not change them, as compressible as the real ones."""
LANES = {
    "nominal": RD_1005,
    "incompressible": INCOMPRESSIBLE,
    "odd": ODD,
    "soft": RIGID,
    "reference": AUTOMOTIVE,
}


class Lane(NamedTuple):
    """One test of the batch, over its second steady cycle."""

    time: np.ndarray
    turns: np.ndarray
    all: dict[str, np.ndarray]
    cycle: np.ndarray

    def __getattr__(self, name: str) -> np.ndarray:
        return self.all[name]


@pytest.fixture(scope="module")
def lanes() -> dict[str, Lane]:
    dampers = jax.tree.map(lambda *leaves: np.array(leaves, float), *LANES.values())
    count = len(LANES)
    same = np.ones(count)
    outset = Outset(YIELD * same, 0.0 * same, 40.0 * same, 40.0 * same)
    courses: Courses = run_tests(dampers, [*[RUN] * (count - 1), FAST], outset, POINTS)
    made = {}
    for k, name in enumerate(LANES):
        time = courses.time[:, k]
        turns = time * (FAST if name == "reference" else RUN).frequency
        cycle = (turns > 1.5 - 1e-9) & (turns < 2.5 + 1e-9)
        columns = {f: getattr(courses, f)[:, k] for f in Courses.__dataclass_fields__}
        made[name] = Lane(time, turns, columns, cycle)
    return made


def test_without_compressibility_the_force_is_that_of_the_flow_at_the_moment(lanes):
    """Q = (A_p − A_r) v, and the pressure that drives it through the valve."""
    lane, d = lanes["incompressible"], INCOMPRESSIBLE
    warm = jnp.asarray(40.0)
    tau = d.oil.yielding(jnp.asarray(YIELD), warm)
    annulus = d.cylinder.bore - d.cylinder.rod

    @jax.jit
    def flow(drop):
        return d.valve.flow(drop, d.oil, tau, warm)

    seen = 0
    for k in np.flatnonzero(lane.cycle)[:: POINTS // 16]:
        v = lane.speed[k]
        if abs(v) < 0.3 * AMPLITUDE * 2 * np.pi * FREQUENCY:
            continue
        through = annulus * v
        found = root_scalar(
            lambda p, q=through: float(flow(jnp.asarray(p))) - q, bracket=(-1e7, 1e7)
        )
        at_poles = float(found.root)
        drop = at_poles + float(d.valve.rest_of_drop(jnp.asarray(through), d.oil, warm))
        fluid = drop * annulus + (lane.far[k] - ATMOSPHERE) * d.cylinder.rod
        slip = float(d.seal.slip_force(jnp.asarray(v), jnp.asarray(lane.near[k] - ATMOSPHERE)))
        friction = np.sign(v) * slip + d.seal.viscous * v
        expected = fluid + friction
        assert lane.force[k] == pytest.approx(expected, abs=1.0)
        assert abs(expected) > 400.0
        seen += 1
    assert seen > 8


def test_a_damper_without_a_rods_volume_and_air_is_odd(lanes):
    """F(φ + π) = −F(φ)."""
    lane = lanes["odd"]
    turns, force = lane.turns[lane.cycle], lane.force[lane.cycle]
    later = np.interp(turns[turns <= 2.0] + 0.5, turns, force)
    first = force[turns <= 2.0]
    assert np.max(np.abs(first + later)) < 5e-3 * np.max(np.abs(force))


def test_the_nominal_damper_is_not_odd(lanes):
    lane = lanes["nominal"]
    turns, force = lane.turns[lane.cycle], lane.force[lane.cycle]
    later = np.interp(turns[turns <= 2.0] + 0.5, turns, force)
    assert np.mean(force[turns <= 2.0] + later) > 200.0


@pytest.mark.parametrize("name", ["nominal", "soft"])
def test_the_work_of_a_cycle_is_the_heat_of_the_cycle(lanes, name):
    lane = lanes[name]
    c = lane.cycle
    work = trapezoid(lane.force[c] * lane.speed[c], lane.time[c])
    heat = trapezoid(lane.heat[c] + lane.gas_heat[c], lane.time[c])
    assert work > 20.0
    assert heat == pytest.approx(work, rel=4e-3)


def test_the_heat_is_where_the_temperatures_say(lanes):
    lane, h = lanes["nominal"], RD_1005.heat
    given = trapezoid(lane.heat + lane.gas_heat, lane.time)
    lost = trapezoid(h.outer * (lane.body - h.room), lane.time)
    stored = h.oil * (lane.oil[-1] - 40.0) + h.body * (lane.body[-1] - 40.0)
    assert stored + lost == pytest.approx(given, rel=2e-3)


def test_at_rest_nothing_moves(lanes):
    rest = at_rest(RD_1005, *(jnp.asarray([x]) for x in (1e-3, 25.0, 25.0)))
    drive = Drive(*(jnp.asarray([x]) for x in (1e-3, 0.0, YIELD, 0.0)))
    _, rate, seen = balance(RD_1005, rest, drive)
    np.testing.assert_allclose(np.asarray(rate)[:12], 0.0, atol=1e-6)
    gas = float(seen.pressures[2][0])
    expected = (gas - ATMOSPHERE) * RD_1005.cylinder.rod
    assert float(seen.force[0]) == pytest.approx(expected, rel=1e-9)
    assert float(seen.ram[0]) == pytest.approx(1e-3, abs=1e-9)
    assert 150.0 < expected < 300.0


def test_the_first_motion_against_radau(lanes):
    """From rest through the first reversal, at a quarter of the steps that data are made with."""
    lane, until, d = lanes["reference"], 0.45, AUTOMOTIVE

    def motion(t):
        turns = t * FAST.frequency  # below the half cycle of the ramp
        rise = 0.5 * (1.0 - jnp.cos(2.0 * jnp.pi * turns))
        return FAST.amplitude * rise * jnp.sin(2.0 * jnp.pi * turns)

    @jax.jit
    def rate(y, t):
        drive = Drive(motion(t), jax.grad(motion)(t), jnp.asarray(YIELD), jnp.asarray(0.0))
        held = jax.jacfwd(lambda x: balance(d, x, drive)[0])(y)
        return jnp.linalg.solve(held, balance(d, y, drive)[1])

    start = np.asarray(at_rest(d, *(jnp.asarray(x) for x in (0.0, 40.0, 40.0))))
    at = np.linspace(0.0, until / FAST.frequency, 400)
    solved = solve_ivp(
        lambda t, y: np.asarray(rate(y, t)), (0.0, at[-1]), start, "Radau", at,
        rtol=1e-4, atol=1e-4, max_step=0.004,
    )  # fmt: skip
    still = Drive(*(jnp.asarray(0.0) for _ in Drive._fields))
    force = jax.vmap(lambda y: balance(d, y, still)[2].force, 1)
    reference = np.asarray(force(jnp.asarray(solved.y)))
    error = CubicSpline(lane.time, lane.force)(at) - reference
    swing = np.ptp(reference)
    assert swing > 1200.0
    # second order: a sixteenth of this is left in the data
    assert np.sqrt(np.mean(error**2)) < 8e-3 * swing
    assert np.max(np.abs(error)) < 4e-2 * swing
