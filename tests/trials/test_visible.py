"""The naming bound against Monte Carlo, and on campaigns whose answer is known."""

import numpy as np
import pytest

from sysid.effects.registry import effect_kind, make
from sysid.identification.fit import fit_loops
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Covariance, Sizes, covariance_parts
from sysid.likelihood.reml import full_rank
from sysid.trials.visible import right_name, seen_by, structural_size, visibilities
from tests.trials.campaigns import SMALL, small_trial

DRAWS = 4000
FEW = tuple(
    make(effect_kind(id))
    for id in ("force_offset", "gas_spring", "fluid_inertia", "fixture_inertia", "asymmetric_gain")
)


@pytest.fixture(scope="module")
def setting():
    """Σ of a rig, a base, a planted force and a rival, all in harmonics; Σ dense as well."""
    loops = small_trial(41).loops.select(np.arange(8))
    basis = harmonic_basis(360, 5)
    parts = covariance_parts(loops, basis)
    sizes = Sizes(gain=6e-3, offset=2.0, delay=1e-4, odd=4e-3, even=1e-6)
    compress = basis.compress
    planted = compress(loops.displacement / np.abs(loops.displacement).max())
    other = compress(loops.displacement**3 / np.abs(loops.displacement).max() ** 3)
    rival = planted + 0.8 * other
    near = other + 0.7 * compress(loops.displacement**5 / np.abs(loops.displacement).max() ** 5)
    base = np.stack([compress(loops.velocity), compress(loops.force), near], axis=2)
    return Covariance(parts, sizes), dense(parts, sizes), base, planted, rival


def dense(parts, sizes):
    """Σ from its formula, [Lm, Lm]."""
    count, m = parts.force.shape
    falls = np.where(parts.order % 2 == 1, sizes.odd, sizes.even) ** 2
    falls = falls / (1.0 + (parts.order / 3.0) ** 4)
    smooth = parts.kernel * np.outer(parts.scale, parts.scale)
    whole = np.kron(smooth, np.diag(falls)) + np.kron(np.diag(parts.noise**2), np.eye(m))
    first = np.eye(m)[0]
    for k in range(count):
        block = slice(k * m, (k + 1) * m)
        whole[block, block] += (
            sizes.gain**2 * np.outer(parts.force[k], parts.force[k])
            + sizes.offset**2 * np.outer(first, first)
            + sizes.delay**2 * np.outer(parts.rate[k], parts.rate[k])
        )
    return whole


def rate_of_right_names(whole, base, planted, rival, size):
    """Share of noisy campaigns in which the planted signature scores higher than its rival."""
    root = np.linalg.cholesky(whole)
    white = lambda z: np.linalg.solve(root, z)  # noqa: E731
    q, _ = np.linalg.qr(white(base.reshape(-1, base.shape[2])))
    free = lambda z: z - q @ (q.T @ z)  # noqa: E731
    a, b = (free(white(g.reshape(-1, 1))) for g in (planted, rival))
    noise = np.random.default_rng(6).normal(size=(a.shape[0], DRAWS))
    seen = free(size * a + noise)
    first, second = (np.abs(g[:, 0] @ seen) / np.linalg.norm(g) for g in (a, b))
    return float(np.mean(first > second))


@pytest.mark.parametrize("right", [0.75, 0.95])
def test_the_bound_is_what_monte_carlo_finds(setting, right):
    covariance, whole, jacobian, planted, rival = setting
    base = full_rank(jacobian)
    unit = seen_by(covariance, base, planted, rival[:, :, None], ["rival"])
    sizes = np.geomspace(0.05, 100.0, 400) / unit.distance
    reached = [right_name(s * unit.distance, unit.likeness) for s in sizes]
    size = sizes[np.argmin(np.abs(np.array(reached) - right))]
    bound = seen_by(covariance, base, size * planted, rival[:, :, None], ["rival"])
    assert bound.distance == pytest.approx(size * unit.distance)
    drawn = rate_of_right_names(whole, base, planted, rival, size)
    error = np.sqrt(right * (1.0 - right) / DRAWS)
    assert bound.right == pytest.approx(drawn, abs=4 * error)
    # taking cos² for the correlation, or forgetting what the base absorbs, promises too much
    assert right_name(bound.distance, bound.likeness**2) > drawn + 4 * error
    some = full_rank(jacobian[:, :, :2])
    ignored = seen_by(covariance, some, size * planted, rival[:, :, None], ["rival"])
    assert ignored.right > drawn + 4 * error


def test_rivals_alike_are_a_coin_toss():
    assert right_name(50.0, 1.0) == pytest.approx(0.5)
    assert right_name(0.0, 0.0) == pytest.approx(0.5)
    assert right_name(6.0, 0.98) == pytest.approx(0.73, abs=0.005), "procedure's example"


def test_a_rival_that_the_base_absorbs_does_not_compete(setting):
    covariance, _, jacobian, planted, _ = setting
    base = full_rank(jacobian)
    alone = seen_by(covariance, base, planted, base[:, :, :1], ["absorbed"])
    assert alone.rival is None
    assert alone.right == right_name(alone.distance, 0.0)


def test_structural_size_is_found_again(setting):
    """Errors drawn from the term of a known size, least squares taken out."""
    base = full_rank(setting[2])
    loops = small_trial(41).loops.select(np.arange(8))
    basis = harmonic_basis(360, 5)
    parts = covariance_parts(loops, basis)
    falls = np.where(parts.order % 2 == 1, 1.0, 0.0) / (1.0 + (parts.order / 3.0) ** 4)
    root = np.linalg.cholesky(parts.kernel + 1e-10 * np.eye(8))
    random = np.random.default_rng(7)
    found = []
    flat = base.reshape(-1, base.shape[2])
    for _ in range(400):
        z = parts.scale[:, None] * (root @ random.normal(size=(8, 11))) * np.sqrt(falls)
        left = 0.02 * z.reshape(-1)
        left = left - flat @ (flat.T @ left)
        found.append(structural_size(parts, left.reshape(8, 11), base) ** 2)
    assert np.sqrt(np.mean(found)) == pytest.approx(0.02, rel=0.05)


@pytest.mark.parametrize(
    ("planter", "visible", "rival"),
    [("bent_load_cell", True, None), ("oil_column", False, "fixture_inertia")],
)
def test_known_campaigns(planter, visible, rival):
    trial = small_trial(42, planter)
    base = fit_loops(trial.loops, variant="symmetric")
    (found,) = visibilities(trial, 42, SMALL, base, effects=FEW)
    assert found.detectable
    assert found.visible is visible
    if rival is not None:
        assert found.rival == rival
        assert found.likeness == pytest.approx(1.0, abs=1e-6)
    assert found.rival not in trial.truth.causes


def test_misfit_hides():
    """What a wrong law could have left as well is harder to see."""
    trial = small_trial(42, "large_gas_chamber")
    base = fit_loops(trial.loops, variant="symmetric")
    (clean,) = visibilities(trial, 42, SMALL, base, effects=FEW)
    wrong = 0.02 * trial.truth.force_without
    (hidden,) = visibilities(trial, 42, SMALL, base, wrong, effects=FEW)
    assert hidden.distance < 0.5 * clean.distance


def test_two_effects_are_seen_apart():
    """Each beyond what base and the other effect absorb."""
    trial = small_trial(42, "bent_load_cell", "gas_preload")
    base = fit_loops(trial.loops, variant="symmetric")
    both = visibilities(trial, 42, SMALL, base, effects=FEW)
    alone = small_trial(42, "gas_preload")
    (single,) = visibilities(alone, 42, SMALL, base, effects=FEW)
    assert len(both) == 2
    assert both[1].distance < single.distance
    assert both[1].distance > 0.5 * single.distance
    assert all(v.rival not in trial.truth.causes for v in both)
