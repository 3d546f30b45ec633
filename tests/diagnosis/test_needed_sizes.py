"""Rivals that tests do not exclude, and their size may."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.bases import Base
from sysid.diagnosis.coarse import BEYOND, largest
from sysid.diagnosis.contenders import Contender
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.ladder import Verdict
from sysid.diagnosis.needed_sizes import needed_sizes
from sysid.diagnosis.prototypes import at_size, magnitudes
from sysid.diagnosis.selection import Selection
from sysid.effects.registry import effect_kind, make
from sysid.models.coordinates import place_of
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import build
from tests.diagnosis.bare import bare
from tests.diagnosis.test_ladder import LOOPS, contender, played

VALVE = build(Generalized, LOW_SYMMETRIC)
MOST = largest(make(effect_kind("fixture_inertia")), magnitudes(LOOPS))


def inertia(mass: float) -> Contender:
    """A rival of that mass, kg."""
    effect = at_size(make(effect_kind("fixture_inertia")), mass)
    one = contender("fixture_inertia", 290.0)
    own = one.state.coordinates.valve_coordinates
    coordinates = DamperCoordinates(own, (effect,))
    u = np.asarray(place_of(coordinates, Damper(VALVE, (effect,))))
    gls = replace(one.state.gls, u=u)
    return replace(one, state=replace(one.state, coordinates=coordinates, gls=gls))


def extended(rival: Contender, status: str, members: tuple[str, ...]) -> Extended:
    rounds = (played(contender("gas_spring", 300.0), rival),)
    return bare(
        Extended,
        base=bare(Base, evidence=bare(type("E", (), {}), loops=LOOPS)),
        selection=bare(Selection, kept=("gas_spring",), rounds=rounds),
        verdicts=(Verdict(status, members, 0.9),),
    )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_mass_that_no_fixture_has_is_told(sign):
    both = ("gas_spring", "fixture_inertia")
    (told,) = needed_sizes(extended(inertia(sign * 3.0 * MOST), "class", both))
    assert told.startswith(f"Inertia of the fixture would have to be {sign * 3.0 * MOST:.2g} kg")
    assert f"have at most {MOST / BEYOND:.2g} kg" in told


def test_nothing_is_told_of_usual_sizes_of_names_and_of_those_that_are_excluded():
    both = ("gas_spring", "fixture_inertia")
    assert needed_sizes(extended(inertia(0.9 * MOST), "class", both)) == ()
    assert needed_sizes(extended(inertia(3.0 * MOST), "named", both[:1])) == ()
    others = ("gas_spring", "bump_stop")
    assert needed_sizes(extended(inertia(3.0 * MOST), "class", others)) == ()
