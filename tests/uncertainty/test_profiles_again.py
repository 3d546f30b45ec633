"""Profiles that find a better place than the fit: they start again, and do so only so often."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.uncertainty import profiles as module
from sysid.uncertainty.profile_paths import AGAIN, Ground, Path, Point, Way
from sysid.uncertainty.profiles import profiles


def moved(point: Point, k: int, by: float, cost: float) -> Point:
    """A point at another value of a parameter, with another cost."""
    return replace(point, cost=cost, theta=point.theta + by * (np.arange(point.theta.size) == k))


@pytest.mark.parametrize("better", [0, 1, AGAIN - 1, AGAIN, 10 * AGAIN])
def test_paths_are_joined_to_the_place_they_start_from(made, monkeypatch, better):
    """Each start finds a better place 10 s/m further on, so many times; there it starts again."""
    k = made.fit.coordinates.free.index("a_0")
    real, starts, said = module.ground_near, [], []

    def ground_near(coordinates, gram_at, u) -> Ground:
        if not starts:
            starts.append(real(coordinates, gram_at, u))
        else:
            best = starts[-1].best
            starts.append(replace(starts[-1], best=moved(best, k, 10.0, best.cost - 9.0)))
        return starts[-1]

    def follow(way: Way) -> Path:
        here = way.ground.best
        end = moved(here, way.k, way.sign, here.cost + 9.0 * way.inflation)
        lower = [moved(here, way.k, 0.5, here.cost - 1.0)]
        return Path((*(lower if way.sign > 0 and len(starts) <= better else ()), end), True)

    monkeypatch.setattr(module, "ground_near", ground_near)
    monkeypatch.setattr(module, "follow", follow)
    (found,) = profiles(made.fit, made.errors, ["a_0"], progress=said.append)
    assert len(starts) == min(better + 1, AGAIN)
    assert found.best == starts[-1].best.theta[k]
    assert found.best - 1.0 < found.low < found.best < found.high < found.best + 1.0
    assert len(said) == min(better, AGAIN)
