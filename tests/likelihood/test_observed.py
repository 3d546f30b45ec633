"""Tests that are simulated in batches come out as they do all together, of one program."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.registry import effect_kind, make
from sysid.likelihood.batches import BATCH, by_batches, in_batches
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.history import run_history, with_history
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import build


def motion_of(count: int) -> Motion:
    grid = np.arange(count)
    motion = sine_motion(
        0.0025 * (1.0 + grid % 9),
        0.5 + 0.25 * (grid % 7),
        0.1 * (grid % 5),
        30.0 + grid % 11,
        points=72,
    )
    return with_history(motion, run_history(grid[::-1], np.asarray(motion.current)[:, 0]))


@pytest.mark.parametrize(
    "id", ["series_compliance", "backlash", "residual_magnetism", "viscosity_temperature"]
)
def test_no_test_feels_the_others_of_its_batch(id):
    """What looks back on the run, at temperature or at travel included."""
    motion = motion_of(3 * BATCH)
    damper = Damper(build(Generalized, LOW_SYMMETRIC), (make(effect_kind(id)),))
    whole = np.asarray(jax.jit(lambda m: damper.force(m))(motion))
    parts = by_batches(jax.jit(lambda m: damper.force(m)), in_batches(motion))
    assert np.abs(np.diff(whole, axis=0)).max() > 100.0, (
        "tests differ, or nothing could be mixed up"
    )
    np.testing.assert_allclose(parts, whole, rtol=1e-9, atol=1e-9 * np.abs(whole).max())


def test_batches_come_one_after_the_other():
    """Each is handed to the work alone, and rows keep their order, whatever is made of them."""
    motion, seen = motion_of(2 * BATCH), []

    def work(some: Motion):
        seen.append(some.displacement.shape[0])
        return some.peak_velocity[:, 0], {"twice": 2.0 * some.frequency}

    peak, more = by_batches(work, in_batches(motion))
    assert set(seen) == {BATCH}
    np.testing.assert_array_equal(peak, motion.peak_velocity[:, 0])
    np.testing.assert_array_equal(more["twice"], 2.0 * jnp.asarray(motion.frequency))
    assert by_batches(work, in_batches(motion_of(BATCH)))[0].shape == (BATCH,)


def test_campaigns_of_other_numbers_of_tests_need_no_other_program():
    """What a model was compiled for is of use to the next campaign."""
    traced = []

    @jax.jit
    def program(some: Motion):
        traced.append(some.displacement.shape)
        return some.frequency

    for batches in (1, 3, 2):
        by_batches(program, in_batches(motion_of(batches * BATCH)))
    assert traced == [(BATCH, 72)]
