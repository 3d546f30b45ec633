"""A candidate whose fit went astray is fitted again before it is thrown away."""

from dataclasses import replace

import equinox as eqx
import numpy as np
import pytest

from sysid.diagnosis import contenders
from sysid.diagnosis.contenders import (
    HOPELESS,
    _again,
    _best_start,
    _first,
    play,
    score_candidates,
    start_with,
    with_effect,
)
from sysid.diagnosis.prototypes import prototypes
from sysid.diagnosis.state import settle


def gain_of_the_spring(evidence, state):
    springs = [e for e in prototypes(evidence.size) if e.facts.id == "gas_spring"]
    (one,) = play(evidence, state, springs).contenders
    return one.gain


@pytest.mark.parametrize("fault", ["worse than without it", "no fit at all", "far too little"])
@pytest.mark.parametrize("spoilt", [1, 2])
def test_a_fit_that_went_astray_is_tried_from_elsewhere(
    evidence, base_state, monkeypatch, fault, spoilt
):
    """The first one or two fits are spoilt; the next one counts."""
    good, calls = gain_of_the_spring(evidence, base_state), []

    def at_fault(found, coordinates, u, covariance=None, **options):
        calls.append(covariance is None)
        state = settle(found, coordinates, u, covariance, **options)
        if len(calls) > spoilt:
            return state
        if fault == "no fit at all":
            raise np.linalg.LinAlgError
        gained = 1.0 if fault == "far too little" else -1000.0
        return replace(state, likelihood=base_state.likelihood + gained)

    monkeypatch.setattr(contenders, "settle", at_fault)
    assert gain_of_the_spring(evidence, base_state) == pytest.approx(good, rel=0.02)
    assert calls == [False, True, True][: spoilt + 1]


@pytest.mark.parametrize(("times", "again"), [(0.9, 2), (1.1, 0)])
def test_what_cannot_win_is_not_tried_again(evidence, base_state, monkeypatch, times, again):
    """Where the best of the others gains far more than the score promises."""
    springs = [e for e in prototypes(evidence.size) if e.facts.id == "gas_spring"]
    scored, calls = score_candidates(evidence, base_state, springs)[0], []
    first = replace(_first(evidence, base_state, scored), fitted=None)

    def fails(*given, **options):
        calls.append(given)
        raise np.linalg.LinAlgError

    monkeypatch.setattr(contenders, "settle", fails)
    found = _again(evidence, base_state, first, times * scored.score / HOPELESS)
    assert found.fitted is None
    assert len(calls) == again


def test_of_fits_that_all_gain_too_little_the_best_is_taken(evidence, base_state, monkeypatch):
    gains = iter([1.0, 3.0, -5.0])

    def little(*given, **options):
        return replace(settle(*given, **options), likelihood=base_state.likelihood + next(gains))

    monkeypatch.setattr(contenders, "settle", little)
    monkeypatch.setattr(contenders, "gained", lambda new, old, _: new.likelihood - old.likelihood)
    assert gain_of_the_spring(evidence, base_state) == pytest.approx(3.0)
    assert next(gains, None) is None, "all three were tried"


def test_a_fit_that_is_fine_is_not_repeated(evidence, base_state, monkeypatch):
    calls = []

    def counted(*given, **options):
        calls.append(1)
        return settle(*given, **options)

    monkeypatch.setattr(contenders, "settle", counted)
    assert gain_of_the_spring(evidence, base_state) > 50.0
    assert len(calls) == 1


@pytest.mark.parametrize("id", ["backlash", "seating_leakage", "fluid_inertia", "force_filter"])
def test_a_fit_does_not_start_with_far_too_much(evidence, base_state, id):
    """Sixteen times the nominal size is far worse than nothing; where the fit starts is not."""
    kind = next(e for e in prototypes(evidence.size) if e.facts.id == id)
    (scored,) = score_candidates(evidence, base_state, [kind])
    size = kind.facts.size
    far = eqx.tree_at(lambda e: getattr(e, size), kind, 16.0 * getattr(kind, size))
    scored = replace(scored, effect=far, expected=float(getattr(far, size)))
    extended = with_effect(base_state.coordinates, far)

    def left(u):
        r = evidence.look(extended, u)[0][:, :, None]
        return float(base_state.covariance.inner(r, r)[0, 0])

    r = base_state.gls.residual[:, :, None]
    without = float(base_state.covariance.inner(r, r)[0, 0])
    assert left(start_with(base_state, extended, scored)) > 5.0 * without
    assert left(_best_start(evidence, base_state, extended, scored)) < 2.0 * without
