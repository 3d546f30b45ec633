"""Directions that information sees, whatever the magnitude of parameters."""

import numpy as np
import pytest

from sysid.uncertainty.directions import OPEN_FACTOR, directions_of

MAGNITUDE = np.array([1e-6, 1.0, 1e5, 3.0])


def information(rank: int) -> np.ndarray:
    J = np.random.default_rng(1).standard_normal((40, rank)) @ np.random.default_rng(2).uniform(
        0.2, 1.0, (rank, 4)
    )
    return J.T @ J / MAGNITUDE[:, None] / MAGNITUDE[None, :]


def test_what_is_seen_in_full_is_inverted():
    H = information(4)
    found = directions_of(H)
    scale = MAGNITUDE[:, None] * MAGNITUDE[None, :]
    assert found.unseen.shape == (4, 0)
    assert found.seen @ found.seen.T / scale == pytest.approx(np.linalg.inv(H * scale), rel=1e-6)


@pytest.mark.parametrize("rank", [0, 1, 3])
def test_what_is_not_seen_is_told_as_open(rank):
    """Seen directions have unit information, the others none, and a sd that nobody overlooks."""
    H = information(rank)
    found = directions_of(H)
    assert found.seen.shape == (4, rank)
    assert found.seen.T @ H @ found.seen == pytest.approx(np.eye(rank), abs=1e-8)
    assert np.abs(found.unseen).max(axis=0) == pytest.approx(OPEN_FACTOR)
    told = found.unseen / np.linalg.norm(found.unseen / MAGNITUDE[:, None], axis=0)
    assert np.abs(told.T @ H @ told) == pytest.approx(np.zeros((4 - rank,) * 2), abs=1e-8)


@pytest.mark.parametrize("idle", [0, 2])
def test_beside_a_parameter_without_effect_rounding_is_nothing(idle):
    """Scaled by what acts on nothing, it would be beyond any number."""
    H = information(2)
    H[idle], H[:, idle] = 0.0, 0.0
    found = directions_of(H)
    assert (found.seen[idle] == 0.0).all()
    assert found.seen.T @ H @ found.seen == pytest.approx(np.eye(2), abs=1e-8)
    assert np.abs(found.unseen).max(axis=0) == pytest.approx(OPEN_FACTOR)
    assert np.count_nonzero(found.unseen[idle]) == 1


def test_a_parameter_without_effect_is_open_alone():
    H = information(4)
    H[2], H[:, 2] = 0.0, 0.0
    found = directions_of(H)
    assert found.unseen[:, 0] == pytest.approx([0.0, 0.0, OPEN_FACTOR, 0.0], abs=1e-6)
    assert found.seen[2] == pytest.approx(np.zeros(3), abs=1e-12)


@pytest.mark.parametrize("turn", range(4))
def test_what_two_parameters_trade_is_told_beside_ones_that_act_on_nothing(turn):
    """Of four parameters two act alike, and two move the force by 10⁻¹⁵ of that, alike as well."""
    by = np.roll([1.0, -2.0, 1e-15, 3e-14], turn)
    J = np.random.default_rng(3).standard_normal((40, 1)) * by
    J = np.concatenate([J, np.random.default_rng(5).standard_normal((40, 1))], axis=1)
    found = directions_of(J.T @ J)
    assert found.unseen.shape == (5, 3)
    open_sd = np.linalg.norm(found.unseen, axis=1)
    assert (open_sd[:4] > 0.1 * OPEN_FACTOR).all()
    assert open_sd[4] < 1e-3
