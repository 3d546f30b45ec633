"""Corner, trace and autocorrelation of made draws, looked at through what is drawn."""

import numpy as np
import pytest

from sysid.models.generalized import Generalized
from sysid.parameters import specs
from sysid.report.corner_plot import corner_figure, corner_png
from sysid.report.trace_plot import plot_autocorrelation, plot_trace, trace_png
from sysid.uncertainty.compression import CompressionError
from sysid.uncertainty.convergence import convergence
from sysid.uncertainty.posterior import Posterior

STEPS, WALKERS = 200, 8


@pytest.fixture(scope="module")
def posterior() -> Posterior:
    rng = np.random.default_rng(0)
    declared = specs(Generalized)[:3]
    u = rng.standard_normal((4, STEPS, WALKERS, 3)) * [1.0, 0.1, 0.2] + [70.0, 0.1, 0.3]
    flat = u.reshape(4, -1, 3)
    return Posterior(
        model="generalized", variant="asymmetric", likelihood="full", assumed="made", prior=(),
        declared=declared, coordinates=flat, draws=flat, log_probability=flat[..., 0],
        walkers=WALKERS, convergence=convergence(u, [s.symbol for s in declared]),
        compression=CompressionError(0.0, 0.0, 1000.0), acceptance=0.3, evaluations=1,
        message="converged",
    )  # fmt: skip


def test_corner_has_a_panel_a_pair_units_on_its_axes_and_the_fit_marked(posterior):
    figure = corner_figure(posterior, {"F_0": 70.5}, symbols=("F_0", "I_1"))
    axes = figure.axes
    assert len(axes) == 4
    assert axes[2].get_xlabel() == "F_0 / N"
    assert axes[2].get_ylabel() == "I_1 / A"
    low, high = axes[2].get_xlim()
    assert 66.0 < low < 68.0
    assert 72.0 < high < 74.0
    marked = [line.get_xdata()[0] for line in axes[0].lines]
    assert 70.5 in marked
    assert corner_png(posterior).startswith(b"\x89PNG")


def test_trace_shows_the_mean_of_each_ensemble(posterior):
    ax = plot_trace(posterior.by_walker[..., 0])
    assert len(ax.lines) == 4
    mean = posterior.by_walker[2, :, :, 0].mean(axis=1)
    np.testing.assert_allclose(ax.lines[2].get_ydata(), mean)


def test_autocorrelation_falls_to_nothing_at_once_where_draws_are_independent(posterior):
    ax = plot_autocorrelation(posterior.by_walker[..., 0], 1.0)
    memory = ax.lines[0].get_ydata()
    assert memory[0] == pytest.approx(1.0)
    assert np.abs(memory[1:]).max() < 0.2
    assert trace_png(posterior).startswith(b"\x89PNG")
