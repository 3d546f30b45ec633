"""Rival models are fitted without a start, and find what made the data."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.features import loop_features
from sysid.identification.fit import fit_loops
from sysid.identification.levenberg_marquardt import descend
from sysid.identification.multistart import in_blocks
from sysid.identification.problem import loop_problem
from sysid.identification.result import Result
from sysid.models.coordinates import valve_at
from sysid.motion.motion import sine_motion
from sysid.parameters import as_dict
from tests.models.rival_examples import example

NOISE = 0.01
# what a wide campaign fixes: the rest are small forces beside large ones
KNOWN = {
    "tanh": ("alpha_a", "alpha_b", "beta", "delta_a", "f_0"),
    "dahl": ("alpha_a", "alpha_b", "rho", "f_0"),
    "bouc_wen": ("alpha_a", "alpha_b", "rho", "sigma", "f_0"),
    "modified_bouc_wen": ("alpha_a", "alpha_b", "rho", "f_0"),
    "carreau": ("alpha_a", "v_0", "n", "h_a", "f_0"),
}


def noisy_loops(name, points=72):
    conditions = [(a, f) for a in (0.0125, 0.025) for f in (0.5, 1.5)] + [(0.005, 4.0)]
    grid = np.array([(a, f, i) for a, f in conditions for i in (0.0, 0.2, 0.4)])
    amplitude, frequency, current = grid.T
    motion = sine_motion(amplitude, frequency, current, points=points)
    clean = np.asarray(example(name).force(motion))
    rms = np.sqrt(np.mean(clean**2, axis=1, keepdims=True))
    cycles = 4
    scatter = (
        rms[:, None] * NOISE * np.random.default_rng(2).standard_normal((len(grid), cycles, points))
    )
    mean = scatter.mean(axis=1)
    return Loops(
        ids=tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A" for a, f, i in grid),
        displacement=np.asarray(motion.displacement), velocity=np.asarray(motion.velocity),
        acceleration=np.asarray(motion.acceleration), force=clean + mean,
        amplitude=amplitude, frequency=frequency, current=current,
        temperature=np.full(len(grid), 40.0), centre=np.zeros(len(grid)),
        cycles=np.full(len(grid), cycles), noise_floor=NOISE * rms[:, 0],
        deviations=tuple(scatter - mean[:, None]),
        displacement_deviations=tuple(np.zeros((len(grid), cycles, points))),
        harmonics=np.eye(1, 15)[0] * amplitude[:, None].astype(complex),
    )  # fmt: skip


@pytest.mark.parametrize("name", ["tanh", "dahl", "bouc_wen", "carreau"])
def test_each_model_finds_itself_without_a_start(name):
    loops = noisy_loops(name)
    fit = fit_loops(loops, model=name, weights="noise")
    assert fit.result is not Result.unfinished
    rms_of_mean = np.sqrt(4 * fit.cost / loops.force.size)
    assert rms_of_mean == pytest.approx(1.0, abs=0.06), "noise of the cycle means is reached"
    found, true = as_dict(fit.valve), as_dict(example(name))
    for symbol in KNOWN[name]:
        assert found[symbol] == pytest.approx(true[symbol], rel=0.05), symbol


def test_one_descent_from_the_features_finds_the_modified_model():
    """All starts take a minute; that the first one alone arrives says what its value is."""
    loops = noisy_loops("modified_bouc_wen")
    problem = loop_problem(loops, "noise")
    kind = family("modified_bouc_wen")
    coordinates = kind.coordinates(problem.reference, "full")
    start = kind.start(loop_features(loops), coordinates)
    end = jax.jit(
        lambda u: descend(coordinates, (in_blocks(problem, 64),), u, tolerance=1e-4, max_steps=60)
    )(jnp.asarray(start))
    scale = np.sum((np.asarray(problem.weight) * loops.force) ** 2)
    rms_of_mean = np.sqrt(4 * float(end.cost) * scale / loops.force.size)
    assert rms_of_mean == pytest.approx(1.0, abs=0.06)
    found = as_dict(valve_at(coordinates, end.u))
    true = as_dict(example("modified_bouc_wen"))
    for symbol in KNOWN["modified_bouc_wen"]:
        assert found[symbol] == pytest.approx(true[symbol], rel=0.05), symbol


def test_another_model_does_not_explain_what_bouc_wen_made():
    fit = fit_loops(noisy_loops("bouc_wen"), model="tanh", weights="peak")
    assert fit.mean_nrmse > 3 * NOISE
