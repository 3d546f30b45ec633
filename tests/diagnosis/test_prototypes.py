"""Candidates of the size of the damper: units decide how each parameter scales."""

import jax
import numpy as np
import pytest

from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.prototypes import (
    SIZES,
    STOPS,
    Magnitudes,
    exponents_of,
    magnitude,
    magnitudes,
    prototypes,
    shape_grid,
)
from sysid.effects.registry import EFFECTS, choices, effect_kind, make
from sysid.identification.problem import loop_problem
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build, specs
from tests.diagnosis.test_invariance import scaled

CATALOGUE = Magnitudes(force=500.0, stroke=0.025, peak=1500.0, travel=0.05, power=80.0)
ABSOLUTE = {"asymmetric_gain", "seal_friction", "position_friction",
             "guide_friction", "shear_thinning", "width_law"}  # fmt: skip
"""Effects with a speed of their own, 0.3 or 1 mm/s, at which the sign of a velocity turns: of slow
tests of a short damper their signatures are others.  And one with a length, 10 mm, a factor of
the width of the base, which absorbs it when fitted (nearly, where only the yield part follows)."""


@pytest.mark.parametrize(
    ("unit", "newton", "metre"),
    [
        ("N", 1, 0), ("m", 0, 1), ("N/m", 1, -1), ("N·s/m", 1, -1), ("m/N", -1, 1), ("1/N", -1, 0),
        ("m/(s·N)", -1, 1), ("kg", 1, -1), ("N·s²/m²", 1, -2), ("m/s", 0, 1), ("s/m", 0, -1),
        ("-", 0, 0), ("s", 0, 0), ("1/K", 0, 0), ("N/K", 1, 0), ("A", 0, 0), ("1/A", 0, 0),
        ("K/J", -1, -1), ("K/W", -1, -1),
    ],
)  # fmt: skip
def test_exponents_of_units(unit, newton, metre):
    assert exponents_of(unit) == (newton, metre)


def test_every_unit_of_the_catalogue_is_understood():
    """What is left of a unit after its symbols is punctuation only."""
    units = {s.unit for kind in EFFECTS for s in specs(kind)}
    plain = {u for u in units if u.strip("kgNmsAKJW1-·/()²") == ""}
    assert units - plain == {"N·(s/m)^n"}, "K v^n: scaled as for n = 1, its size is linear"


def test_the_catalogue_s_own_damper_gets_the_nominal_values():
    for effect in prototypes(CATALOGUE):
        for spec in specs(effect):
            if spec.symbol not in ("x_b", "l_g", "q_F"):
                nominal = effect.facts.nominal[spec.symbol]
                assert float(getattr(effect, spec.symbol)) == pytest.approx(nominal)


def test_prototypes_are_the_effects_that_loops_can_show_in_every_form():
    found = [e.facts.id for e in prototypes(CATALOGUE)]
    shown = [k for k in EFFECTS if k.facts.found_from == "loops"]
    assert sorted(found) == sorted(k.facts.id for k in shown for _ in choices(k))
    both = {e.facts.id for e in prototypes(CATALOGUE, ("loops", "history"))}
    assert both - set(found) == {k.facts.id for k in EFFECTS if k.facts.found_from == "history"}


def test_thirty_times_the_force_and_a_fifth_of_the_stroke_scale_every_parameter():
    other = Magnitudes(force=15e3, stroke=0.005, peak=45e3, travel=0.01, power=500.0)
    for here, there in zip(prototypes(CATALOGUE), prototypes(other), strict=True):
        for spec in specs(here):
            newton, metre = exponents_of(spec.unit)
            expected = 30.0**newton * 0.2**metre
            found = float(getattr(there, spec.symbol)) / float(getattr(here, spec.symbol))
            assert found == pytest.approx(expected), (here.facts.id, spec.symbol)
            assert magnitude(spec.unit, other) == pytest.approx(expected)


def test_shapes_cover_their_realistic_range():
    friction = make(effect_kind("presliding_friction"))
    grid = shape_grid(friction, CATALOGUE)
    for spec in specs(friction):
        if spec.symbol != friction.facts.size:
            values = {float(getattr(e, spec.symbol)) for e in grid}
            assert set(friction.facts.realistic[spec.symbol]) <= values
    assert len(shape_grid(make(effect_kind("gas_spring")), CATALOGUE)) == 1


def test_stops_begin_within_the_travel_of_the_campaign():
    grid = shape_grid(make(effect_kind("bump_stop")), CATALOGUE)
    begins = sorted({float(e.x_b) for e in grid})  # type: ignore[attr-defined]  # a bump stop
    assert begins == pytest.approx([share * CATALOGUE.travel for share in STOPS])


def test_effects_that_change_shape_with_size_are_tried_at_several_sizes():
    play = make(effect_kind("backlash"))
    sizes = sorted(float(e.delta) for e in shape_grid(play, CATALOGUE))  # type: ignore[attr-defined]  # backlash
    assert sizes == pytest.approx([part * float(play.delta) for part in SIZES["backlash"]])  # type: ignore[attr-defined]  # backlash


def test_magnitudes_of_a_campaign(spring_trial):
    size = magnitudes(spring_trial.loops)
    assert size.force == pytest.approx(np.sqrt(np.mean(spring_trial.loops.force**2)))
    assert size.travel == pytest.approx(spring_trial.loops.amplitude.max(), rel=1e-3)
    assert size.stroke == np.median(spring_trial.loops.amplitude)
    assert size.peak == np.abs(spring_trial.loops.force).max()


def shown(evidence: Evidence, coordinates: GeneralizedCoordinates, u: jax.Array):
    """Id → what each candidate at its own size adds to the force, parts of the RMS force."""
    valve = coordinates.valve(u)
    found = []
    for effect in prototypes(evidence.size):
        size = float(getattr(effect, effect.facts.size))
        added = size * evidence.signature(Damper(valve, (effect,)))
        found.append((effect.facts.id, added / evidence.size.force))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("force", "length"), [(30.0, 1.0), (1.0, 0.2)])
def test_on_a_scaled_damper_every_effect_has_the_same_relative_signature(
    force, length, spring_trial, evidence
):
    """Coordinates are dimensionless, so the valve is scaled by scaling the loops."""
    loops = spring_trial.loops
    coordinates = GeneralizedCoordinates(loop_problem(loops).reference, "symmetric")
    u = coordinates.locate(build(Generalized, LOW_SYMMETRIC))
    here = shown(evidence, coordinates, u)
    changed = scaled(loops, force=force, length=length)
    other = GeneralizedCoordinates(loop_problem(changed).reference, "symmetric")
    different = set()
    for (name, a), (same, b) in zip(here, shown(gather(changed), other, u), strict=True):
        assert name == same
        assert 1e-4 < np.abs(a).max() < 10.0, name
        if np.linalg.norm(b - a) > 1e-5 * np.linalg.norm(a):
            different.add(name)
    assert different == (ABSOLUTE if length != 1.0 else set())
