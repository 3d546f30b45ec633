"""Laws of a swept damper in Σ: bent over temperature, and the yield force by itself."""

from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.likelihood.discrepancy import LAWS, Parts, Sizes
from sysid.likelihood.kernel import LENGTHS, WARM, kernel_of
from sysid.likelihood.reml import fit_sizes
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped, element_force
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from sysid.uncertainty.error_model import ErrorModel, errors_at
from sysid.uncertainty.law_errors import law_errors, steady_cycles
from sysid.uncertainty.sample import observed_of
from tests.data.loop_of import loops_of
from tests.likelihood.dense import draw
from tests.uncertainty.one_spread import spread_of

GAIN, THERMOMETER = 6e-3, 0.3
"""Of the rig; K."""
LAWS_ERR = Sizes(gain=GAIN, offset=2.0, delay=1e-4, thermometer=0.3, scale=0.09, growth=0.09)
"""F_y and C_post wrong by 9 %, each on its own."""


@pytest.fixture(scope="module")
def swept() -> Loops:
    """BS09's damper at seven temperatures, C_post and F_y bent by 5 % there, on a rig that errs."""
    amplitude, frequency = np.array([10e-3, 5e-3]), np.array([8.0, 4.0])
    which, current, warm = (
        z.ravel() for z in np.meshgrid([0, 1], [0.0, 0.2, 0.6, 1.0], np.linspace(15.0, 75.0, 7))
    )
    rng = np.random.default_rng(5)
    felt = warm + THERMOMETER * rng.standard_normal(warm.size)
    a, f = amplitude[which.astype(int)], frequency[which.astype(int)]
    motion = sine_motion(a, f, current, felt, points=360)
    element = build(Lumped, TABLE_1).element(motion)
    z = (felt[:, None] - 45.0) / 30.0
    bent = element._replace(
        post=element.post * (1.0 + 0.05 * (1.5 * z**2 - 0.5)),
        yielding=element.yielding * (1.0 - 0.05 * (1.5 * z**2 - 0.5)),
    )
    force = np.asarray(element_force(bent, motion))
    force = force * (1.0 + GAIN * rng.standard_normal((len(a), 1)))
    noise = 0.01 * np.abs(force).max(axis=1)[:, None, None]
    cycles = noise * rng.standard_normal((len(a), 10, 360))
    mean = cycles.mean(axis=1)
    made = loops_of(force + mean, a, f, current)
    return replace(
        made, temperature=warm, cycles=np.full(len(a), 10),
        deviations=tuple(cycles - mean[:, None]),
        displacement_deviations=tuple(np.zeros_like(cycles)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def fit(swept) -> Fit:
    return fit_loops(swept, model="lumped", max_waves=1)


@pytest.fixture(scope="module")
def errors(fit, swept) -> ErrorModel:
    return errors_at(fit, observed_of(fit, swept))


def test_the_rig_is_found_as_it_is(swept, fit, errors):
    """With errors of the laws alike at all temperatures, what bends there is taken for its own."""
    assert errors.observed.parts.lengths[3] >= WARM
    assert near_the_rig(errors.sizes)
    u = np.asarray(fit.u)
    observed = observed_of(fit, swept)
    residual, jacobian = observed.look(fit.coordinates, u)
    parts = observed.beside(Damper(valve_at(fit.coordinates, jnp.asarray(u))), residual).parts
    alike = fit_sizes(replace(parts, kernel=kernel_of(swept, LENGTHS)), residual, jacobian)
    assert not near_the_rig(alike.sizes)
    assert alike.sizes.thermometer > 3.0 * errors.sizes.thermometer


def test_errors_of_laws_are_known_at_temperatures_of_the_sweep_and_not_far_from_them(fit, errors):
    """The same excitation and current, warmer by several correlation lengths."""
    motion = sine_motion(
        np.full(2, 10e-3), np.full(2, 8.0), np.full(2, 0.2), np.array([45.0, 400.0]), points=72
    )
    residual = errors.observed.residual(fit.coordinates, np.asarray(fit.u))
    every = np.broadcast_to(residual, (400, *residual.shape))
    found = law_errors(
        errors, fit.coordinates, every, steady_cycles(motion), np.random.default_rng(1)
    )
    scale = found.amplitudes[:, :, -len(LAWS)].std(axis=0)
    assert scale[1] == pytest.approx(errors.sizes.scale, rel=0.2)
    assert scale[0] < 0.3 * scale[1]


@dataclass(frozen=True)
class Wrong:
    """What Σ is made of at the fit, and errors of F_y and C_post.

    Attributes:
        apart: The yield force errs without the viscous one.
        whole: They err together.
        jacobian: [L, m, n] of the fit's parameters.
        drawn: [L, m] N each, with the sizes of `LAWS_ERR`.
    """

    apart: Parts
    whole: Parts
    jacobian: np.ndarray
    drawn: tuple[np.ndarray, ...]

    def found(self, believed: Parts) -> list[Sizes]:
        """By REML."""
        return [fit_sizes(believed, e, self.jacobian).sizes for e in self.drawn]

    def sd(self, fit: Fit, parts: Parts, sizes: Sizes) -> np.ndarray:
        """Of the yield forces with current, by plain least squares."""
        J = self.jacobian / np.linalg.norm(self.jacobian, axis=(0, 1))
        spread = spread_of(np.einsum("lmi,lmj->ij", J, J), J, parts, sizes)
        some = [s.startswith("F_y") and "[0 A]" not in s for s in fit.coordinates.free]
        return np.sqrt(np.diagonal(spread.covariance))[some]


@pytest.fixture(scope="module")
def wrong(fit, swept) -> Wrong:
    observed = observed_of(fit, swept)
    residual, jacobian = observed.look(fit.coordinates, np.asarray(fit.u))
    damper = Damper(valve_at(fit.coordinates, jnp.asarray(fit.u)))
    apart, whole = (
        replace(observed.beside(damper, residual, apart=own).parts, error=np.inf)
        for own in (True, False)
    )
    drawn = tuple(draw(apart, LAWS_ERR, seed) for seed in range(6))
    return Wrong(apart, whole, jacobian, drawn)


def test_laws_that_err_apart_are_found_as_they_are(wrong):
    sizes = wrong.found(wrong.apart)
    for name in ("scale", "growth", "gain"):
        mean = np.exp(np.mean([np.log(getattr(s, name)) for s in sizes]))
        assert mean == pytest.approx(getattr(LAWS_ERR, name), rel=0.35)


def test_yield_forces_are_as_unsure_as_they_are_and_too_sure_where_only_the_whole_force_errs(
    fit, wrong
):
    """Standard deviations over those of the covariance that the errors were drawn from."""
    true = wrong.sd(fit, wrong.apart, LAWS_ERR)
    right, narrow = (
        np.array([np.median(wrong.sd(fit, parts, s) / true) for s in wrong.found(parts)])
        for parts in (wrong.apart, wrong.whole)
    )
    assert np.median(right) == pytest.approx(1.0, abs=0.2)
    assert (narrow < 0.95 * right).all()


def near_the_rig(sizes: Sizes) -> bool:
    """Gain and thermometer are about those of the rig."""
    return 0.6 * GAIN < sizes.gain < 1.6 * GAIN and sizes.thermometer < 2.0 * THERMOMETER
