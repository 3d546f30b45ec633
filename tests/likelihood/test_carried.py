"""Σ carried through a weighted sum, part by part, against Σ written out."""

from dataclasses import fields, replace

import numpy as np
import pytest

from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import NAMES, Parts, Sizes
from tests.likelihood.dense import dense

NOTHING = Sizes(**dict.fromkeys((f.name for f in fields(Sizes)), 0.0))
SOME = Sizes(0.01, 3.0, 2e-4, 0.02, 0.01, 0.03, 0.04, 0.02, 0.05, 0.5)


@pytest.fixture(scope="module")
def parts() -> Parts:
    rng = np.random.default_rng(0)
    loops, order = 6, np.concatenate([[0], np.repeat(np.arange(1, 4), 2)])
    shape = (loops, order.size)
    root = rng.standard_normal((loops, loops))
    return Parts(
        noise=rng.uniform(0.1, 1.0, loops),
        force=100.0 * rng.standard_normal(shape),
        rate=1e3 * rng.standard_normal(shape),
        scale=rng.uniform(50.0, 200.0, loops),
        order=order,
        kernel=root @ root.T + np.eye(loops),
        warmth=rng.standard_normal(shape),
        laws=100.0 * rng.standard_normal((4, *shape)),
        error=0.1,
    )


@pytest.fixture(scope="module")
def weights(parts) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((*parts.force.shape, 3))


def test_the_parts_add_up_to_what_the_matrix_gives(parts, weights):
    flat = weights.reshape(-1, 3)
    expected = flat.T @ dense(parts, SOME) @ flat
    np.testing.assert_allclose(carried(parts, SOME, weights).sum(axis=0), expected, rtol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_each_part_is_that_of_its_size(parts, weights, name):
    flat = weights.reshape(-1, 3)
    only = replace(NOTHING, **{name: getattr(SOME, name)})
    expected = flat.T @ (dense(parts, only) - dense(parts, NOTHING)) @ flat
    found = carried(parts, SOME, weights)[1 + NAMES.index(name)]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())


def test_what_sigma_lacks_is_zero(parts, weights):
    bare = replace(parts, laws=np.zeros((0, 0, 0)), warmth=np.zeros((0, 0)))
    found = carried(bare, SOME, weights)
    absent = [1 + NAMES.index(n) for n in ("thermometer", "scale", "width", "steepness", "growth")]
    assert not found[absent].any()
    np.testing.assert_allclose(
        found.sum(axis=0),
        weights.reshape(-1, 3).T @ dense(bare, SOME) @ weights.reshape(-1, 3),
        rtol=1e-9,
    )
