"""Descriptors against closed forms."""

from collections.abc import Callable

import numpy as np
import pytest

from sysid.data.cycles import cut_loops
from sysid.data.descriptors import Descriptors, describe
from tests.data.loop_of import loops_of
from tests.data.synthetic import make_record

A, F, POINTS = 0.0125, 1.5, 360
W = 2.0 * np.pi * F
V = A * W
Law = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def of(law: Law) -> Descriptors:
    """Descriptors of one loop; the law takes x, v and sgn ẍ."""
    phase = 2.0 * np.pi * np.arange(POINTS) / POINTS
    x, v, side = A * np.sin(phase), V * np.cos(phase), -np.sign(np.round(np.sin(phase), 12))
    one = np.array([1.0])
    return describe(loops_of(law(x, v, side)[None], A * one, F * one, 0.0 * one))


def test_linear_viscous_damper() -> None:
    c = 2000.0
    found = of(lambda x, v, side: c * v + 50.0)
    assert found.energy[0] == pytest.approx(np.pi * W * A**2 * c, rel=1e-12)
    assert found.equivalent_damping[0] == pytest.approx(c, rel=1e-12)
    assert found.effective_stiffness[0] == pytest.approx(0.0, abs=1e-6)
    assert found.peak_compression[0] == pytest.approx(c * V + 50.0)
    assert found.peak_rebound[0] == pytest.approx(c * V - 50.0)
    assert found.asymmetry[0] == pytest.approx((c * V - 50.0) / (c * V + 50.0))
    assert found.gas_force[0] == pytest.approx(50.0)
    assert found.reversal_force[0] == pytest.approx(50.0)
    assert found.velocity_intercept[0] == pytest.approx(0.0, abs=1e-4 * V)
    assert found.velocity_offset[0] == pytest.approx(50.0 / c, rel=1e-3)
    assert found.force_width[0] == pytest.approx(0.0, abs=1e-9)


def test_a_linear_damper_has_no_knee() -> None:
    found = of(lambda x, v, side: 2000.0 * v)
    assert np.isnan(found.knee_velocity[0])
    assert found.yield_share[0] == pytest.approx(0.0, abs=1e-3)
    assert found.post_yield_damping[0] == pytest.approx(2000.0, rel=1e-3)


def test_viscoelastic_ellipse() -> None:
    """F = c v + k x: width 2 k A at v = 0, zero force at |u| = sin(atan(kA/cV))."""
    c, k = 1500.0, 6000.0
    found = of(lambda x, v, side: c * v + k * x)
    assert found.energy[0] == pytest.approx(np.pi * c * W * A**2, rel=1e-12)
    assert found.effective_stiffness[0] == pytest.approx(k, rel=1e-12)
    assert found.force_width[0] == pytest.approx(2.0 * k * A, rel=1e-3)
    intercept = -V * np.sin(np.arctan2(k * A, c * V))
    assert found.velocity_intercept[0] == pytest.approx(-intercept, rel=1e-3)
    assert found.velocity_width[0] == pytest.approx(-2.0 * intercept, rel=1e-3)
    assert found.peak_compression[0] == pytest.approx(np.hypot(c * V, k * A), rel=1e-4)


def test_spring_alone_takes_no_energy() -> None:
    found = of(lambda x, v, side: 6000.0 * x)
    assert found.energy[0] == pytest.approx(0.0, abs=1e-12)
    assert found.effective_stiffness[0] == pytest.approx(6000.0)


@pytest.mark.parametrize("v_h", [0.0, 0.02])
@pytest.mark.parametrize("b", [60.0, 150.0])
def test_knee_of_a_hyperbolic_tangent(b: float, v_h: float) -> None:
    """v_knee = 2 artanh(1/2)/b + order of the slope left; W11's hysteresis shifts it out."""
    found = of(lambda x, v, side: 800.0 * np.tanh(b * (v - side * v_h)))
    saturated = 2.0 * np.arctanh(0.5) / b
    assert found.knee_velocity[0] == pytest.approx(saturated, rel=0.05)
    assert found.yield_force[0] == pytest.approx(800.0, rel=0.03)
    assert found.velocity_intercept[0] == pytest.approx(v_h, abs=2e-3 * V)
    assert found.velocity_offset[0] == pytest.approx(0.0, abs=1e-3 * V)


def test_force_that_leads_velocity_has_a_negative_intercept() -> None:
    found = of(lambda x, v, side: 800.0 * np.tanh(80.0 * (v + side * 0.02)))
    assert found.velocity_intercept[0] == pytest.approx(-0.02, abs=2e-3 * V)


def test_knee_and_line_of_a_biviscous_element() -> None:
    pre, post, f_y = 40000.0, 1500.0, 700.0
    v_y = f_y / (pre - post)

    def law(x: np.ndarray, v: np.ndarray, side: np.ndarray) -> np.ndarray:
        return np.where(np.abs(v) <= v_y, pre * v, np.sign(v) * f_y + post * v)

    found = of(law)
    assert found.knee_velocity[0] == pytest.approx(v_y, rel=0.01)
    assert found.yield_force[0] == pytest.approx(f_y, rel=0.01)
    assert found.post_yield_damping[0] == pytest.approx(post, rel=0.01)
    assert found.pre_yield_damping[0] == pytest.approx(pre, rel=0.01)
    assert found.yield_share[0] == pytest.approx(f_y / (f_y + post * V), rel=0.01)


def test_coulomb_friction_dissipates_four_strokes() -> None:
    found = of(lambda x, v, side: 300.0 * np.sign(np.round(v, 12)))
    assert found.energy[0] == pytest.approx(4.0 * A * 300.0, rel=1e-3)


def test_wide_hysteresis_tells_no_knee() -> None:
    found = of(lambda x, v, side: 800.0 * np.tanh(80.0 * (v - side * 0.7 * V)))
    assert np.isnan(found.knee_velocity[0])
    assert found.velocity_intercept[0] == pytest.approx(0.7 * V, rel=0.01)


def test_force_that_never_changes_sign_has_no_intercept() -> None:
    found = of(lambda x, v, side: 100.0 * v + 500.0)
    assert np.isnan(found.velocity_intercept[0])
    assert found.asymmetry[0] < 0.0


def test_frame_has_units_and_every_descriptor() -> None:
    frame = of(lambda x, v, side: 2000.0 * v).to_frame()
    assert list(frame.index) == ["test0"]
    assert {"energy_J", "equivalent_damping_N*s/m", "knee_velocity_m/s", "asymmetry"} <= set(frame)
    assert frame.shape[1] == len(Descriptors.__dataclass_fields__) - 1


def test_energy_of_a_cut_loop_is_that_of_the_record() -> None:
    """∮F dx from the loop against the trapezoid sum over the record's whole cycles."""
    record = make_record(cycles=9.0, start_phase=0.0, rate=4000.0)
    loops = cut_loops([record]).loops
    work = np.sum(0.5 * (record.force[1:] + record.force[:-1]) * np.diff(record.displacement))
    assert describe(loops).energy[0] == pytest.approx(work / 9.0, rel=1e-3)
