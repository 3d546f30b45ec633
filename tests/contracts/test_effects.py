"""Every claim that an effect makes about itself, checked on one grid of the W11 matrix."""

import dataclasses
import re
from functools import cache

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.parity import parity_shares
from sysid.diagnosis.prototypes import at_size
from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
    AbstractLawEffect,
    AbstractMotionEffect,
)
from sysid.effects.registry import EFFECTS, choices, effect_kind, make
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.history import run_history, with_history
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build, specs
from tests.contracts.outcomes import (
    FORM_IDS,
    FORMS,
    Outcome,
    arranged,
    force_of,
    share_off,
    table_of,
)

CATALOGUE = (
    "force_offset", "load_cell_gain", "gas_spring", "gas_polytropic", "gas_temperature",
    "fluid_inertia", "fixture_inertia", "force_delay", "force_filter", "velocity_delay",
    "seal_friction", "stribeck_friction", "presliding_friction", "position_friction",
    "series_compliance", "backlash", "entrained_air", "shear_thinning", "quadratic_loss",
    "linear_viscosity", "frequency_law", "viscosity_temperature", "yield_temperature",
    "self_heating", "stiffness_temperature", "residual_magnetism", "magnetic_hysteresis",
    "coil_lag", "eddy_loss", "current_saturation", "bypass_leakage", "bump_stop",
    "asymmetric_gain", "force_clipping", "force_quantization", "mains_hum", "displacement_zero",
    "waveform_distortion", "first_cycle_breakaway", "run_drift", "surface_temperature",
)  # fmt: skip
NEW = ["seating_leakage", "width_law", "guide_friction"]
STAGES = {
    "drive": AbstractDriveEffect,
    "motion": AbstractMotionEffect,
    "law": AbstractLawEffect,
    "force": AbstractForceEffect,
    "channel": AbstractChannelEffect,
}
CONDITIONS = (
    *((2.5, f) for f in (0.5, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0)),
    *((12.5, f) for f in (0.1, 0.5, 1.5, 2.5, 5.0)),
    *((25.0, f) for f in (0.1, 0.5, 1.5, 2.5)),
    *((50.0, f) for f in (0.1, 0.5, 1.0)),
    *((75.0, f) for f in (0.1, 0.5, 0.75)),
)
"""22 conditions of W11's matrix with v_m ≤ 0.4 m/s, mm and Hz."""
CURRENTS = (0.1, 0.2, 0.4)
VALVE = build(Generalized, LOW_SYMMETRIC)
UNSEEN = {"coil_lag", "displacement_zero"}
"""Nothing on steady loops at constant current with a valve that does not know its place."""

each = pytest.mark.parametrize("kind", EFFECTS, ids=lambda kind: kind.facts.id)
each_form = pytest.mark.parametrize(("kind", "choice"), FORMS, ids=FORM_IDS)


@cache
def grid(points: int = 72) -> Motion:
    amplitude, frequency = np.repeat(np.array(CONDITIONS), len(CURRENTS), axis=0).T
    current = np.tile(CURRENTS, len(CONDITIONS))
    temperature = np.full(current.size, 50.0)
    motion = sine_motion(1e-3 * amplitude, frequency, current, temperature, points=points)
    order = np.random.default_rng(5).permutation(current.size).astype(float)
    return with_history(motion, run_history(order, current), cycle=np.ones(current.size))


@cache
def base() -> np.ndarray:
    return np.asarray(VALVE.force(grid()))


@cache
def computed(kind: type[AbstractEffect], form: tuple) -> tuple[Outcome, np.ndarray]:
    """The outcome, and the nominal force without vmap."""
    force = force_of(kind, dict(form), VALVE, grid())
    table = table_of(kind)[0]
    rows = np.asarray(jax.jit(jax.vmap(force))(table))

    @jax.jit
    def both(vector: jax.Array) -> tuple[jax.Array, jax.Array]:
        return force(vector), jax.jacfwd(force)(vector)

    (alone, jacobian), (_, at_zero) = (both(jnp.asarray(row)) for row in table[:2])
    slopes = [np.moveaxis(np.asarray(z), -1, 0) for z in (jacobian, at_zero)]
    return arranged(kind, rows, *slopes), np.asarray(alone)


def outcome(kind: type[AbstractEffect], choice: dict | None = None) -> Outcome:
    return computed(kind, tuple((choice or choices(kind)[0]).items()))[0]


def test_ids_are_the_catalogues_in_its_order():
    ids = [kind.facts.id for kind in EFFECTS]
    assert ids == [*CATALOGUE, *NEW]


@each
def test_declaration(kind):
    facts = kind.facts
    symbols = [spec.symbol for spec in specs(kind)]
    fields = [f.name for f in dataclasses.fields(kind)]
    assert kind.__mro__[1] is STAGES[kind.stage], "a direct, final member of its stage"
    assert set(symbols) <= set(fields)
    assert facts.size in symbols
    assert set(facts.nominal) == set(facts.realistic) == set(symbols)
    for spec in specs(kind):
        low, high = facts.realistic[spec.symbol]
        assert low <= facts.nominal[spec.symbol] <= high
        assert spec.check(facts.nominal[spec.symbol]) is None
        assert set(re.split(r"[·/()^²n]+", spec.unit)) <= {
            "",
            "-",
            "1",
            "m",
            "N",
            "s",
            "kg",
            "A",
            "K",
            "J",
            "W",
        }
        assert spec.name
    assert specs(kind)[symbols.index(facts.size)].check(0.0) is None
    assert set(facts.rivals) <= {*CATALOGUE, *NEW} - {facts.id}
    assert facts.separating_test
    assert "_" not in facts.separating_test, "people read it: no id of another effect"
    assert facts.source
    assert effect_kind(facts.id) is kind


@each
def test_docstring_has_equation_and_source(kind):
    doc = kind.__doc__
    assert "Source:" in doc
    equations = [s for s in doc.splitlines() if s.startswith("        ") and ("=" in s or "←" in s)]
    assert equations


@each_form
def test_zero_size_is_the_identity(kind, choice):
    np.testing.assert_allclose(
        outcome(kind, choice).zero, base(), rtol=0.0, atol=1e-12 * base().max()
    )


@each_form
def test_effect_is_finite_and_does_something(kind, choice):
    result = outcome(kind, choice)
    for values in (result.nominal, result.jacobian, result.at_zero):
        assert np.isfinite(values).all()
    added = np.sqrt(np.mean((result.nominal - base()) ** 2)) / np.sqrt(np.mean(base() ** 2))
    if kind.facts.id in UNSEEN:
        assert added < 1e-12
    else:
        assert 1e-4 < added < 0.5


@each_form
def test_vmap_and_jit_agree(kind, choice):
    result, alone = computed(kind, tuple(choice.items()))
    np.testing.assert_allclose(alone, result.nominal, rtol=0.0, atol=1e-6)


@each_form
def test_derivatives_are_those_of_finite_differences(kind, choice):
    """To 10⁻⁴ of the largest; up to 1 % of the points may lie at a kink within the step."""
    result = outcome(kind, choice)
    for k, symbol in enumerate(result.symbols):
        off = share_off(result, k)
        assert off <= 0.01, f"{symbol}: {off:.1%} of the points"


@each
def test_parity_is_as_claimed(kind):
    added = outcome(kind).nominal - base()
    shares = parity_shares(added)
    if kind.facts.parity is None:
        assert max(shares.values()) < 0.8 or kind.facts.id in UNSEEN
    else:
        parity, share = kind.facts.parity
        assert parity == max(shares, key=lambda p: shares[p])
        assert shares[parity] == pytest.approx(share, abs=0.05)


@each
def test_exponents_are_as_claimed(kind):
    if kind.facts.exponents is None:
        return
    size = np.sqrt(np.mean((outcome(kind).nominal - base()) ** 2, axis=1))
    m = grid()
    amplitude = np.asarray(m.displacement).max(axis=1)
    columns = [amplitude, np.asarray(m.frequency)[:, 0], np.asarray(m.current)[:, 0]]
    table = np.stack([*np.log(columns), np.ones(size.size)], axis=1)
    found = np.linalg.lstsq(table, np.log(size), rcond=None)[0][:3]
    np.testing.assert_allclose(found, kind.facts.exponents, atol=0.1)


@each
def test_more_of_an_effect_that_names_what_grows_with_it_is_more_of_the_same_force(kind):
    """Half of friction that builds up over a travel builds up over the same travel."""
    if not kind.facts.with_size:
        return
    effect = make(kind)
    added = []
    for part in (1.0, 0.02):
        damper = Damper(VALVE, (at_size(effect, part * float(getattr(effect, kind.facts.size))),))
        added.append((np.asarray(damper.force(grid())) - base()) / part)
    np.testing.assert_allclose(added[1], added[0], atol=1e-9 * np.abs(added[0]).max())
    alone = eqx.tree_at(
        lambda e: getattr(e, kind.facts.size), effect, 0.02 * getattr(effect, kind.facts.size)
    )
    other = (np.asarray(Damper(VALVE, (alone,)).force(grid())) - base()) / 0.02
    assert np.abs(other - added[0]).max() > 0.1 * np.abs(added[0]).max(), (
        "it claims this for nothing"
    )


@each
def test_what_claims_no_exponents_follows_no_power_law(kind):
    if kind.facts.exponents is not None or kind.facts.id in UNSEEN:
        return
    size = np.sqrt(np.mean((outcome(kind).nominal - base()) ** 2, axis=1))
    assert np.ptp(np.log(np.maximum(size, 1e-12))) > 0.1 or kind.facts.family == "acquisition"


@each
def test_no_effect_makes_the_damper_a_source_of_energy(kind):
    """∮ F v dφ stays positive; what the force stage adds by friction or flow is a loss too."""
    v = np.asarray(grid().velocity)
    result = outcome(kind)
    assert (np.sum(result.nominal * v, axis=1) > 0.0).all()
    if kind.stage != "force" or kind.facts.parity is None:
        return
    work = np.sum((result.nominal - base()) * v, axis=1)
    least = 1e-10 * np.sum(base() * v, axis=1)
    if kind.facts.parity[0] == "OD":
        assert (work > 0.0).all()
    else:
        assert (np.abs(work) < least).all(), "a spring, a mass or an offset keeps what it takes"


@each
def test_any_motion_has_a_finite_force(kind):
    """Nothing fails off cycles: irregular motion, unknown temperature, varying current."""
    force = eqx.filter_jit(lambda effect, m: Damper(VALVE, (effect,)).force(m))
    motion = swept()
    values = np.asarray(force(make(kind), motion))
    assert np.isfinite(values).all()
    zero = np.asarray(force(make(kind, "zero"), motion))
    np.testing.assert_allclose(zero, VALVE.force(motion), rtol=0.0, atol=1e-8)


@cache
def swept() -> Motion:
    t = np.arange(400) / 400.0
    x = 0.008 * np.sin(2.0 * np.pi * (1.0 + 2.0 * t) * t)
    return time_motion(t, x, current=0.2 + 0.1 * np.sin(9.0 * t))
