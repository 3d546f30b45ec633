"""What holds for every planter, whatever its physics."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sysid.rig.planters
from sysid.errors import DataError
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.rig.planters.bench_state import BenchState, steady_bench
from sysid.rig.planters.planter import STAGES, Planter, plant_all
from sysid.rig.planters.registry import CATALOGUE, HISTORY, OUTSIDE, PLANTERS, find_planter
from sysid.rig.planters.valve import HystereticValve
from sysid.rig.trial_matrix import settings_below
from sysid.rig.trial_size import planted_size, scaled_to

FAMILIES = {
    "offset", "acquisition", "reactive", "gas_nonlinear", "timing", "friction", "lost_motion",
    "viscous", "rate_law", "thermal", "current_law", "run_history",
}  # fmt: skip
"""Of the catalogue."""

each_planter = pytest.mark.parametrize("planter", PLANTERS, ids=lambda planter: planter.name)


@pytest.fixture(scope="module")
def bench() -> BenchState:
    """W11's damper in 22 tests at 0, 0.2 and 0.4 A, 25 to 55 °C, run in no special order."""
    settings = settings_below(0.4)[::5]
    currents = np.array([0.0, 0.2, 0.4])[np.arange(len(settings)) % 3]
    return steady_bench(
        HystereticValve(LOW_SYMMETRIC),
        np.array([setting.amplitude for setting in settings]),
        np.array([setting.frequency for setting in settings]),
        currents,
        temperature=np.linspace(25.0, 55.0, len(settings)),
        run_order=np.argsort(np.sin(7.0 * np.arange(len(settings)))) + 1,
    )


def split(force: np.ndarray) -> dict[str, float]:
    """Energy of the four symmetries: odd/even in φ + π, dissipative/conservative in π − φ."""
    points = force.shape[1]
    half = np.roll(force, -points // 2, axis=1)
    back = (points // 2 - np.arange(points)) % points
    shares = {}
    for name, part in (("O", force - half), ("E", force + half)):
        mirrored = part[:, back]
        shares[name + "D"] = float(np.sum((part - mirrored) ** 2))
        shares[name + "C"] = float(np.sum((part + mirrored) ** 2))
    total = sum(shares.values())
    return {name: share / total for name, share in shares.items()}


@each_planter
def test_size_zero_changes_nothing(planter: Planter, bench: BenchState):
    planted = replace(planter, size=0.0).plant(bench)
    np.testing.assert_allclose(planted.force, bench.force, rtol=0, atol=1e-7)
    if planted.departures is not None:
        assert np.max(np.abs(planted.departures)) < 1e-9


@each_planter
@pytest.mark.parametrize("percent", [1.0, 4.0])
def test_size_is_reached(planter: Planter, percent: float, bench: BenchState):
    scaled = scaled_to(planter, bench, percent)
    planted = scaled.plant(bench)
    power = np.mean((planted.force - bench.force) ** 2)
    if planted.departures is not None:
        power += np.mean(planted.departures**2)
    reached = 100.0 * np.sqrt(power / np.mean(bench.force**2))
    assert reached == pytest.approx(percent, rel=0.05)
    assert planted_size(scaled, bench) == pytest.approx(reached)
    assert replace(scaled, size=planter.size) == planter


@each_planter
def test_recorded_motion_and_conditions_stay(planter: Planter, bench: BenchState):
    planted = planter.plant(bench)
    for name in ("displacement", "velocity", "amplitude", "current", "temperature"):
        assert np.array_equal(getattr(planted, name), getattr(bench, name)), name
    assert planted.force.shape == bench.force.shape
    assert np.all(np.isfinite(planted.force))


@pytest.mark.parametrize(
    "planter", [p for p in PLANTERS if p.dissipates], ids=lambda planter: planter.name
)
def test_dissipating_ones_never_give_energy(planter: Planter, bench: BenchState):
    added = planter.plant(bench).force - bench.force
    assert np.all(np.mean(added * bench.velocity, axis=1) > -1e-12)


@pytest.mark.parametrize(
    ("name", "parity", "share"),
    [
        ("gas_preload", "EC", 0.999),
        ("warm_gas", "EC", 0.999),
        ("large_gas_chamber", "OC", 0.99),
        ("balanced_gas_chamber", "EC", 0.85),
        ("oil_column", "OC", 0.999),
        ("rubber_stop", "OC", 0.999),
        ("rubber_bush", "OC", 0.999),
        ("oil_film", "OD", 0.999),
        ("orifice", "OD", 0.999),
        ("shear_thinning_gap", "OD", 0.999),
        ("shim_stack", "OD", 0.999),
        ("stiff_seal", "OD", 0.9),
        ("side_load", "ED", 0.85),
        ("bent_load_cell", "EC", 0.85),
    ],
)
def test_symmetry_follows_from_the_physics(name: str, parity: str, share: float, bench: BenchState):
    added = find_planter(name).plant(bench).force - bench.force
    assert split(added)[parity] >= share


@pytest.mark.parametrize(
    "name", ["rod_play", "loose_pin", "soft_mount", "leaking_piston", "late_sampling"]
)
def test_symmetric_parts_keep_half_wave_symmetry(name: str, bench: BenchState):
    shares = split(find_planter(name).plant(bench).force - bench.force)
    assert shares["ED"] + shares["EC"] < 1e-3
    assert min(shares["OD"], shares["OC"]) > 0.05


@pytest.mark.parametrize("name", ["gas_pocket", "collapsing_bubble"])
def test_one_sided_parts_have_every_symmetry(name: str, bench: BenchState):
    shares = split(find_planter(name).plant(bench).force - bench.force)
    assert min(shares.values()) > 0.15


def test_effects_of_the_field_vanish_without_field(bench: BenchState):
    off = bench.current == 0.0
    for name in ("eddy_currents", "warm_particles", "saturated_core", "fading_magnet"):
        added = find_planter(name).plant(bench).force - bench.force
        assert np.max(np.abs(added[off])) < 1e-9, name
        assert np.min(np.max(np.abs(added[~off]), axis=1)) > 0.0, name


def test_names_families_and_causes():
    names = [planter.name for planter in PLANTERS]
    assert len(set(names)) == len(names)
    assert all(p.causes and p.family in FAMILIES for p in CATALOGUE + HISTORY)
    assert len(OUTSIDE) >= 8
    assert all(not p.causes for p in OUTSIDE)
    assert all(p.family is None or p.family in FAMILIES for p in OUTSIDE)
    assert any(p.family is None for p in OUTSIDE)
    assert find_planter("soft_mount") in PLANTERS
    with pytest.raises(DataError, match="no planter 'soft mount'"):
        find_planter("soft mount")


def test_several_effects_act_in_the_order_of_the_signal(bench: BenchState):
    late, heavy = find_planter("late_sampling"), find_planter("oil_column")
    both = plant_all((late, heavy), bench)
    assert STAGES.index(heavy.stage) < STAGES.index(late.stage)
    np.testing.assert_array_equal(both.force, late.plant(heavy.plant(bench)).force)
    assert not np.allclose(both.force, heavy.plant(late.plant(bench)).force, atol=0.1)


@pytest.mark.parametrize("first", ["vogel_oil", "rod_play", "remanence", "loose_pin"])
@pytest.mark.parametrize("second", ["soft_mount", "eddy_currents", "leaking_piston", "oil_film"])
def test_neither_of_two_effects_undoes_the_other(first: str, second: str, bench: BenchState):
    one, other = (scaled_to(find_planter(name), bench, 1.0) for name in (first, second))
    both = plant_all((one, other), bench).force
    for alone in (one, other):
        assert np.sqrt(np.mean((both - alone.plant(bench).force) ** 2)) > 0.006 * np.sqrt(
            np.mean(bench.force**2)
        )


def test_a_size_out_of_reach_is_refused(bench: BenchState):
    with pytest.raises(DataError, match="eddy_currents cannot be given a size of 99 %"):
        scaled_to(find_planter("eddy_currents"), bench, 99.0)


def test_planters_are_numpy_and_their_own_physics():
    allowed = ("numpy", "jaxtyping", "sysid.errors", "sysid.rig.planters")
    standard = {"abc", "collections.abc", "dataclasses", "math", "typing"}
    seen = 0
    for path in sysid.rig.planters.__path__:
        for file in sorted(Path(path).glob("*.py")):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                names = []
                if isinstance(node, ast.ImportFrom):
                    names = [node.module or ""]
                elif isinstance(node, ast.Import):
                    names = [alias.name for alias in node.names]
                for name in names:
                    seen += 1
                    assert name in standard or name.startswith(allowed), f"{file.name}: {name}"
    assert seen > 100
