"""What planters call a size, in the catalogue's parameters: the forces must agree."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import least_squares, minimize_scalar

from sysid.effects.motion.backlash import Backlash
from sysid.effects.registry import effect_kind
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.rig.planters.registry import CATALOGUE
from sysid.trials.quantities import true_quantities
from tests.trials.campaigns import small_trial


def apart(name: str, form: dict[str, str] | None = None) -> tuple[float, bool]:
    """Relative RMS difference of the planter's force and the effect's with the true values."""
    trial = small_trial(71, name)
    quantities = [q for q in true_quantities(trial) if form is None or q.form == form]
    kind = effect_kind(quantities[0].id)
    values = dict(kind.facts.nominal) | {q.symbol: q.value for q in quantities}
    effect = kind(**{k: np.float64(v) for k, v in values.items()}, **(form or {}))
    assert all(q.of(effect) for q in quantities)
    valve = build(Generalized, trial.truth.parameters)
    motion = loop_motion(trial.loops)
    added = np.asarray(Damper(valve, (effect,)).force(motion) - valve.force(motion))
    planted = trial.truth.force - trial.truth.force_without
    return float(np.linalg.norm(added - planted) / np.linalg.norm(planted)), quantities[0].exact


@pytest.mark.parametrize(
    "name",
    ["gas_preload", "large_gas_chamber", "balanced_gas_chamber", "warm_gas", "oil_column",
     "late_sampling", "stiff_seal", "breakaway_seal", "side_load", "shear_thinning_gap",
     "orifice", "oil_film", "converter_limit", "vogel_oil", "warm_particles", "eddy_currents",
     "bent_load_cell", "soft_seal"],
)  # fmt: skip
def test_forces_agree(name):
    distance, exact = apart(name)
    assert distance < (0.25 if exact else 0.6)


def test_a_filter_of_two_poles_is_the_planted_one_and_one_pole_is_only_near():
    distances = {}
    for poles in ("two", "one"):
        distances[poles], exact = apart("butterworth_channel", {"poles": poles})
        assert exact == (poles == "two")
    assert distances["two"] < 0.02
    assert 1.5 * distances["two"] < distances["one"] < 0.6


def test_a_size_belongs_to_the_form_of_the_effect():
    true = true_quantities(small_trial(71, "butterworth_channel"))
    found = effect_kind("force_filter")(np.float64(1e-3), poles="two")
    (own,) = [q for q in true if q.of(found)]
    assert own.value == small_trial(71, "butterworth_channel").truth.nominal[0]["size"]


@pytest.mark.parametrize(("name", "joint"), [("rod_play", "held"), ("loose_pin", "loose")])
def test_a_gap_has_the_same_length_in_both(name, joint):
    """The gap with which the catalogue's effect comes nearest to what was planted."""
    trial = small_trial(71, name)
    true = true_quantities(trial)[0].value
    valve, motion = build(Generalized, trial.truth.parameters), loop_motion(trial.loops)

    def left(part: float) -> float:
        damper = Damper(valve, (Backlash(jnp.asarray(part * true), joint=joint),))
        return float(np.sum((np.asarray(damper.force(motion)) - trial.truth.force) ** 2))

    found = minimize_scalar(left, bounds=(0.8, 1.2), method="bounded", options={"xatol": 1e-4})
    assert found.x == pytest.approx(1.0, abs=0.02)


def test_a_mass_behind_play_has_its_size_and_so_has_the_play():
    """The momentum of what stood in the gap is none that a spring would have to stand in for."""
    trial = small_trial(71, "oil_column", "rod_play")
    mass, gap = trial.truth.planters[0].mass, trial.truth.planters[1].size
    valve, motion = build(Generalized, trial.truth.parameters), loop_motion(trial.loops)

    def left(parts: np.ndarray) -> np.ndarray:
        inertia = effect_kind("fluid_inertia")(jnp.asarray(parts[1] * mass))
        damper = Damper(valve, (Backlash(jnp.asarray(parts[0] * gap)), inertia))
        return (np.asarray(damper.force(motion)) - trial.truth.force).ravel()

    found = least_squares(left, [1.0, 1.0], diff_step=1e-3)
    np.testing.assert_allclose(found.x, 1.0, atol=0.01)


def test_planters_are_their_own_physics():
    """Were a planter the catalogue's formula, hiding it would prove nothing."""
    distances = [apart(name)[0] for name in ("large_gas_chamber", "bent_load_cell", "stiff_seal")]
    assert min(distances) > 1e-4


def test_every_planter_of_the_catalogue_has_a_size_but_those_of_another_form():
    without = {p.name for p in CATALOGUE if not true_quantities(small_trial(71, p.name))}
    assert without == {"relaxing_chains", "rubber_stop"}
