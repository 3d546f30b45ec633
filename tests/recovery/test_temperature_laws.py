"""A slice of `benchmarks/temperature_laws.py`: lines stay lines, and a real bend is found."""

import jax.numpy as jnp
import numpy as np
import pytest
from temperature_laws import RIVALS, campaign, compared

from sysid.identification.fit import fit_loops
from sysid.identification.temperature_laws import compare_laws, left_out_squares
from sysid.models.bent_lumped import bent


@pytest.mark.parametrize("seed", [0, 1])
def test_straight_lines_are_not_called_bent(seed):
    told = compared(campaign(None, seed))
    assert told.blocks == 14
    assert not any(law.curved for law in told.laws)
    for law in told.laws:
        assert abs(law.middle - 0.5) < 0.05
        assert abs(law.gain) < 0.1 * told.error


@pytest.mark.parametrize("law", RIVALS, ids=["Arrhenius", "Vogel", "steep"])
def test_a_viscosity_of_liquids_is_found_bent_and_no_other_law(law):
    told = compared(campaign(law, 0))
    viscosity, *others = told.laws
    assert viscosity.curved
    assert viscosity.error < 0.95 * told.error
    assert not any(other.curved for other in others)
    middle = (1.0 - law.factor(np.array([45.0]))) / (1.0 - law.factor(np.array([75.0])))
    assert viscosity.middle == pytest.approx(middle.item(), abs=0.04)


def test_leaving_out_is_exact_for_a_linear_model():
    rng = np.random.default_rng(4)
    X, y, block = rng.standard_normal((60, 4)), rng.standard_normal(60), np.repeat(np.arange(6), 2)
    beta = np.linalg.lstsq(X, y, rcond=None)[0]
    full = np.concatenate([X, (X @ beta - y)[:, None]], axis=1).reshape(12, 5, 5)
    found = left_out_squares(np.einsum("lpi,lpj->lij", full, full), block)
    for number in range(6):
        out = np.repeat(block == number, 5)
        other = np.linalg.lstsq(X[~out], y[~out], rcond=None)[0]
        expected = ((X[out] @ other - y[out]) ** 2).reshape(2, 5).sum(axis=1)
        np.testing.assert_allclose(found[block == number], expected, rtol=1e-9)


def test_the_bend_passes_through_zero_smoothly():
    share = jnp.linspace(0.0, 1.0, 7)
    for b in (-2e-3, -9e-4, -1e-9, 0.0, 9e-4, 2e-3):
        near = share + b * share * (1.0 - share) / 2.0
        np.testing.assert_allclose(bent(share, jnp.asarray(b)), near, atol=1e-6)
    assert float(bent(jnp.asarray([0.5]), jnp.asarray(2.0))[0]) == pytest.approx(0.7310585786)


def test_two_temperatures_cannot_tell():
    loops = campaign(None, 0)
    ends = np.flatnonzero(np.isin(loops.temperature, (15.0, 75.0)))
    as_many = np.resize(ends, len(loops.ids))  # again and again, or all is compiled once more
    told = compare_laws(fit_loops(loops.select(as_many), model="lumped", max_waves=1))
    assert isinstance(told, str)
    assert "3 temperatures" in told
