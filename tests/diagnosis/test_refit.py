"""A candidate whose fit went astray is fitted again before it is thrown away."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis import selection
from sysid.diagnosis.prototypes import prototypes
from sysid.diagnosis.selection import play
from sysid.diagnosis.state import settle


def gain_of_the_spring(evidence, state):
    springs = [e for e in prototypes(evidence.size) if e.facts.id == "gas_spring"]
    (one,) = play(evidence, state, springs).contenders
    return one.gain


@pytest.mark.parametrize("fault", ["worse than without it", "no rest", "no fit at all"])
def test_a_fit_that_went_astray_is_tried_from_elsewhere(evidence, base_state, monkeypatch, fault):
    """The first fit, under the Σ of the model before, is spoilt; what counts is the best."""
    good, calls = gain_of_the_spring(evidence, base_state), []

    def spoilt(found, coordinates, u, covariance=None, **options):
        calls.append(covariance is None)
        state = settle(found, coordinates, u, covariance, **options)
        if covariance is None:
            return state
        if fault == "no fit at all":
            raise np.linalg.LinAlgError
        if fault == "no rest":
            return replace(state, gls=replace(state.gls, converged=False), likelihood=-1e6)
        return replace(state, likelihood=base_state.likelihood - 1000.0)

    monkeypatch.setattr(selection, "settle", spoilt)
    assert gain_of_the_spring(evidence, base_state) == pytest.approx(good, rel=0.02)
    assert calls.count(True) == 2


def test_a_fit_that_is_fine_is_not_repeated(evidence, base_state, monkeypatch):
    calls = []

    def counted(*given, **options):
        calls.append(1)
        return settle(*given, **options)

    monkeypatch.setattr(selection, "settle", counted)
    assert gain_of_the_spring(evidence, base_state) > 50.0
    assert len(calls) == 1
