"""What may be proposed where a base is far off: sizes that a damper can have."""

from dataclasses import replace

import pytest

from sysid.diagnosis.coarse import BEYOND, largest
from sysid.diagnosis.prototypes import FORCE, STROKE, Magnitudes, prototypes
from sysid.effects.registry import EFFECTS, effect_kind, make

CAMPAIGN = Magnitudes(
    force=2.0 * FORCE, stroke=0.1 * STROKE, peak=6.0 * FORCE, travel=0.5 * STROKE, power=100.0
)
"""Of a damper twice as strong as the catalogue's, on half of its travel."""


@pytest.mark.parametrize(
    ("id", "symbol", "factor"),
    [
        ("series_compliance", "s_k", 0.5 / 2.0),
        ("backlash", "delta", 0.5),
        ("fixture_inertia", "m_x", 2.0 / 0.1),
        ("gas_spring", "k_g", 2.0 / 0.1),
        ("linear_viscosity", "c_1", 2.0 / 0.1),
        ("force_offset", "F_off", 2.0),
        ("force_filter", "tau_c", 1.0),
        ("width_law", "p_w", 1.0),
    ],
)
def test_a_size_may_be_what_suits_the_damper(id, symbol, factor):
    """Of a damper that is as long as the travel of the tests, or as their median amplitude."""
    kind = effect_kind(id)
    limit = BEYOND * factor * max(abs(z) for z in kind.facts.realistic[symbol])
    assert largest(make(kind), CAMPAIGN) == pytest.approx(limit)


def test_limits_scale_with_the_damper():
    spring = make(effect_kind("series_compliance"))
    lengths = {"stroke": 0.2 * CAMPAIGN.stroke, "travel": 0.2 * CAMPAIGN.travel}
    other = replace(CAMPAIGN, force=30.0 * CAMPAIGN.force, **lengths)
    assert largest(spring, other) == pytest.approx(largest(spring, CAMPAIGN) * 0.2 / 30.0)


@pytest.mark.parametrize("kind", EFFECTS, ids=lambda kind: kind.facts.id)
@pytest.mark.parametrize("travel", [1.0, 6.0])
def test_no_effect_is_refused_at_the_size_that_it_is_scored_at(kind, travel):
    """W11's matrix has a travel of six median amplitudes: there viscosity was refused at half."""
    size = replace(CAMPAIGN, travel=travel * CAMPAIGN.stroke)
    for stroke in (size.stroke, size.travel):
        scored = prototypes(replace(size, stroke=stroke), ("loops", "cycles", "history"))
        for effect in (e for e in scored if isinstance(e, kind)):
            assert abs(float(getattr(effect, kind.facts.size))) <= largest(effect, size)
