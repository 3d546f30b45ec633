"""Bands that hold the truth as often as they say, and those that do not; readings off a force."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.identification.fit import fit_loops
from sysid.likelihood.discrepancy import LAWS, Covariance, Sizes
from sysid.likelihood.gls import gauss_newton
from sysid.likelihood.observed import Observed, observe
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.motion.motion import loop_motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.uncertainty.bands import Prediction, beyond, predict, predict_at
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.force_draws import batch_of
from sysid.uncertainty.law_errors import steady_cycles
from sysid.uncertainty.quantities import ENERGY, PEAK, QUANTITIES, STANDSTILL
from sysid.uncertainty.target import motion_of
from tests.identification.campaigns import HIGH_DESIGN, LOW_DESIGN, virtual_loops
from tests.likelihood.dense import dense
from tests.uncertainty.conftest import PASSIVE

RIG = Sizes(gain=0.006, offset=1.0, delay=1e-4)
WITH_LAWS = dataclasses.replace(
    RIG, odd=0.01, even=0.003, scale=0.02, width=0.03, steepness=0.02, growth=0.02
)
DRAWS, POINTS, CAMPAIGNS = 200, 72, 40
NEW = (4, 7)
"""Tests that are not fitted."""


@dataclasses.dataclass(frozen=True)
class Lab:
    """A damper on a rig, whose tests are drawn from Σ itself."""

    fit: object
    observed: Observed
    force: np.ndarray

    def campaign(
        self, sizes: Sizes, seed: int, believed: Sizes
    ) -> tuple[ErrorModel, np.ndarray, np.ndarray]:
        """A likelihood fitted to all tests but `NEW`; truth and new records of all, on points."""
        parts = self.observed.parts
        rng = np.random.default_rng(seed)
        quiet = dataclasses.replace(parts, noise=np.full(len(parts.noise), 1e-6))
        of_laws = dataclasses.replace(sizes, gain=0.0, offset=0.0, delay=0.0)
        laws = _draw(dense(quiet, of_laws), rng)
        error = laws + _draw(dense(parts, RIG), rng)
        waves = np.asarray(self.observed.columns).T * POINTS
        truth = self.force + laws @ waves
        white = parts.noise[:, None] * np.sqrt(360.0) * rng.standard_normal(truth.shape)
        record = truth + _draw(dense(quiet, RIG), rng) @ waves + white
        kept = np.ones(len(parts.noise), dtype=bool)
        kept[list(NEW)] = False
        loops = self.observed.loops.select(kept)
        seen = dataclasses.replace(
            observe(loops, points=POINTS),
            measured=(self.observed.measured + error)[kept],
            parts=parts.of(kept),
        )
        covariance = Covariance(seen.parts, believed)
        coordinates = self.fit.coordinates
        gls = gauss_newton(lambda u: seen.look(coordinates, u), self.fit.u, covariance)
        plain = error_model(self.fit, seen, "independent")
        found = dataclasses.replace(
            plain, kind="full", observed=seen, sizes=believed, covariance=covariance,
            u=gls.u, information=gls.information,
        )  # fmt: skip
        return found, truth, record


def _draw(sigma: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """By the symmetric root: that of Σ's axes alone turns with the last digit of Σ."""
    values, axes = np.linalg.eigh(sigma)
    root = (axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T
    return (root @ rng.standard_normal(len(values))).reshape(-1, 31)


@pytest.fixture(scope="module")
def lab() -> Lab:
    """Nine tests of a known model; noise alone comes from these loops."""
    loops = virtual_loops(PASSIVE, LOW_DESIGN + HIGH_DESIGN, (0.0,), noise=0.02, seed=4)
    fit = fit_loops(loops, variant="passive", weights="peak")
    seen = observe(loops, points=POINTS)
    u = np.asarray(fit.u)
    force = np.asarray(valve_at(fit.coordinates, jnp.asarray(u)).force(seen.motion))[: seen.tests]
    residual = seen.look(fit.coordinates, u)[0]
    seen = seen.beside(Damper(valve_at(fit.coordinates, jnp.asarray(u))), residual)
    return Lab(fit, dataclasses.replace(seen, measured=seen.measured - residual), force)


def normal_draws(errors: ErrorModel, wider: float, seed: int) -> np.ndarray:
    """The posterior where all is nearly linear, or one that is too wide or too narrow."""
    root = np.linalg.cholesky(np.linalg.inv(errors.information))
    z = np.random.default_rng([seed, 7]).standard_normal((DRAWS, len(root)))
    return errors.u + wider * z @ root.T


def coverage(lab, true_sizes, kind, *, wider=1.0, believed=None, seeds=CAMPAIGNS) -> float:
    """Share of points whose truth (or record) is inside, over all tests of many campaigns."""
    hits = []
    motion = motion_of(lab.observed)
    for seed in range(seeds):
        errors, truth, record = lab.campaign(true_sizes, seed, believed or true_sizes)
        u = normal_draws(errors, wider, seed)
        found = predict_at(u, lab.fit.coordinates, motion, errors=errors, seed=seed)
        band = found.band(kind)
        hits.append(band.holds(record if kind == "recorded" else truth).mean())
    return float(np.mean(hits))


@pytest.mark.parametrize(
    ("wider", "least", "most"),
    [(1.0, 0.90, 0.98), (2.0, 0.985, 1.01), (0.5, 0.45, 0.8)],
    ids=["right", "too wide", "too narrow"],
)
def test_bands_of_parameters_hold_the_truth_if_the_laws_are_right(lab, wider, least, most):
    assert least < coverage(lab, RIG, "parameters", wider=wider) < most


def test_where_laws_are_wrong_bands_hold_the_damper_if_such_errors_are_as_large_as_believed(lab):
    assert coverage(lab, WITH_LAWS, "laws") == pytest.approx(0.95, abs=0.025)
    assert coverage(lab, WITH_LAWS, "laws", believed=_times(WITH_LAWS, 0.1)) < 0.75
    assert coverage(lab, WITH_LAWS, "laws", believed=_times(WITH_LAWS, 5.0)) > 0.97


def _times(sizes: Sizes, factor: float) -> Sizes:
    names = ("odd", "even", *LAWS)
    return dataclasses.replace(sizes, **{n: factor * getattr(sizes, n) for n in names})


def test_bands_of_records_hold_what_a_new_test_records(lab):
    assert coverage(lab, WITH_LAWS, "recorded") == pytest.approx(0.95, abs=0.025)


def test_a_band_of_the_posterior_is_that_of_its_draws(drawn, made):
    posterior, _ = drawn
    motion = loop_motion(made.loops)
    found = predict(posterior, made.fit.coordinates, motion)
    band = found.band()
    assert isinstance(found, Prediction)
    assert band.low.shape == made.loops.force.shape
    spread = 0.5 * (band.high - band.low) / 1.96
    u = made.errors.u
    slopes = made.errors.observed.look(made.fit.coordinates, u)[1] @ np.linalg.cholesky(
        np.linalg.inv(made.errors.information)
    )
    known = np.sqrt(np.sum(slopes**2, axis=(1, 2)))
    assert np.sqrt(np.mean(spread**2, axis=1)) / known == pytest.approx(
        np.ones(len(known)), abs=0.12
    )
    for quantity in QUANTITIES:
        read = found.reading(quantity)
        assert (read.low < read.middle).all()
        assert (read.middle < read.high).all()


def test_on_any_motion_parameters_alone_are_known(drawn, made):
    posterior, _ = drawn
    time = np.linspace(0.0, 2.0, 400)
    x = 0.008 * np.sin(2.0 * np.pi * time) + 0.002 * np.sin(2.0 * np.pi * 2.7 * time)
    motion = time_motion(time, x, current=0.0)
    found = predict(posterior, made.fit.coordinates, motion, errors=made.errors)
    band = found.band()
    assert band.low.shape == (1, 400)
    force = np.asarray(made.fit.valve.force(motion))
    assert np.mean((force > band.low[0]) & (force < band.high[0])) > 0.9
    energy = found.reading(ENERGY)
    assert energy.low[0] < energy.middle[0] < energy.high[0]
    for kind in ("laws", "recorded"):
        with pytest.raises(ValueError, match="on any other motion"):
            found.band(kind)


def test_a_likelihood_without_errors_of_laws_refuses_a_band_of_them(drawn, made):
    posterior, _ = drawn
    found = predict(posterior, made.fit.coordinates, loop_motion(made.loops), errors=made.errors)
    with pytest.raises(ValueError, match="takes the model's laws to be right"):
        found.band("laws")
    assert found.band("recorded").holds(made.loops.force).mean() == pytest.approx(0.95, abs=0.03)


def test_it_is_said_in_what_a_condition_is_beyond_the_campaign(made):
    wanted = steady_cycles(
        sine_motion(*np.array([[0.0125, 0.030, 0.0125], [1.0, 1.0, 30.0], [0.0, 0.3, 0.0]]))
    )
    assert beyond(made.loops, wanted) == ("", "amplitude, current", "frequency, speed")


def test_readings_are_those_of_closed_forms():
    a, f, c, k = 0.01, 2.0, 800.0, 3000.0
    omega = 2.0 * np.pi * f
    motion = sine_motion(a, f, 0.0, points=360)
    force = (c * np.asarray(motion.velocity) + k * np.asarray(motion.displacement))[None]
    assert ENERGY.read(force, motion)[0, 0] == pytest.approx(np.pi * c * omega * a**2)
    assert STANDSTILL.read(force, motion)[0, 0] == pytest.approx(k * a)
    assert PEAK.read(force, motion)[0, 0] == pytest.approx(np.hypot(k * a, c * omega * a), rel=1e-4)
    time = np.linspace(0.0, 3.0 / f, 3001)
    phase = omega * time
    record = time_motion(
        time, a * np.sin(phase), velocity=a * omega * np.cos(phase),
        acceleration=-a * omega**2 * np.sin(phase), current=0.0,
    )  # fmt: skip
    record = batch_of(record)
    force = (c * np.asarray(record.velocity) + k * np.asarray(record.displacement))[None]
    assert ENERGY.read(force, record)[0, 0] == pytest.approx(3 * np.pi * c * omega * a**2, rel=1e-5)
    assert STANDSTILL.read(force, record)[0, 0] == pytest.approx(k * a, rel=1e-5)
    still = dataclasses.replace(motion, velocity=jnp.abs(motion.velocity))
    assert np.isnan(STANDSTILL.read(force[:, :, :360], still)).all()


def test_it_is_said_where_it_is_warmer_than_in_any_test_that_was_fitted(made):
    """As far as temperatures are known, and by more than two thermocouples differ."""
    count = len(made.loops.ids)
    warm = np.where(np.arange(count) % 2, 20.0 + np.arange(count), np.nan)
    high = float(np.nanmax(warm))
    asked = [10.0, high - 1.0, high + 1.5, 90.0]
    wanted = steady_cycles(sine_motion(*np.array([[0.0125] * 4, [1.0] * 4, [0.0] * 4, asked])))
    loops = dataclasses.replace(made.loops, temperature=warm)
    assert beyond(loops, wanted) == ("temperature", "", "", "temperature")
    unknown = dataclasses.replace(wanted, temperature=np.full(4, np.nan))
    assert beyond(loops, unknown) == ("",) * 4
    nowhere = dataclasses.replace(loops, temperature=np.full(count, np.nan))
    assert beyond(nowhere, wanted) == ("",) * 4
