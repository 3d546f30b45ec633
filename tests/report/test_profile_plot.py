"""Pictures of profiles: a path over many decades stays readable."""

import numpy as np
import pytest

from sysid.parameters import ParamSpec
from sysid.report.profile_plot import plot_profile, profile_png
from sysid.uncertainty.profiles import Profile


def profile(values: np.ndarray) -> Profile:
    rise = 2.5 * (1.0 - np.exp(-(np.log(values / values[1]) ** 2)))
    return Profile(
        declared=ParamSpec(
            symbol="k_3", name="growth of the loop width with current", unit="-", low=0.0,
            high=np.inf, typical=10.0, scale="linear",
        ),
        best=float(values[1]), values=values, rise=rise, others=values[:, None], symbols=("k_3",),
        low=float(values[0]), high=np.inf, closed=(True, False),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        (np.array([6.0, 12.0, 50.0, 1e3, 4e5]), "log"),
        (np.array([6.0, 12.0, 20.0, 40.0]), "linear"),
        (np.array([7e-7, 6e-6, 1.3e-4, 2e-4]), "linear"),  # begins at a bound of zero
    ],
)
def test_a_path_over_many_decades_is_drawn_over_the_logarithm(values: np.ndarray, scale: str):
    ax = plot_profile(profile(values))
    assert ax.get_xscale() == scale
    curve, points = ax.lines[0], ax.lines[1]
    np.testing.assert_allclose(np.asarray(points.get_xydata())[:, 0], values)
    x, y = np.asarray(curve.get_xydata()).T
    assert (x[0], x[-1]) == pytest.approx((values[0], values[-1]))
    # through the points, and not above them between the last two, which are alike
    np.testing.assert_allclose(np.interp(values, x, y), 0.5 * profile(values).rise, atol=0.05)
    assert profile_png([profile(values)]).startswith(b"\x89PNG")
