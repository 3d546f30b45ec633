"""What was held out, in words, where it is not what one would think."""

from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.acting import not_known
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.diagnosis.words import EFFECT_WORDS, capital, condition_words, listed
from sysid.identification.conditions import conditions
from sysid.models.coordinates import valve_at

MOST: Final = 3
"""Conditions that are told by name."""


def what_was_held_out(evidence: Evidence, state: State) -> tuple[str, ...]:
    """Notes on errors at tests that were not seen.

    Args:
        evidence: The campaign.
        state: The extended model, fitted to all tests.
    """
    return (*_parted(evidence), *_alone(evidence, state))


def _parted(evidence: Evidence) -> tuple[str, ...]:
    """Few excitations are held out in parts, by temperature (`held_together`)."""
    count = np.unique(conditions(evidence.loops)).size
    if np.unique(evidence.condition).size == count:
        return ()
    of = "one amplitude and frequency" if count == 1 else f"{count} amplitudes and frequencies"
    return (
        f"These tests are of {of}: they were left out in parts, by temperature. Errors on tests "
        "not seen are between colder and warmer tests of the same amplitude and frequency, and "
        "tell nothing of others.",
    )


def _alone(evidence: Evidence, state: State) -> tuple[str, ...]:
    """Effects that act in tests of one condition alone."""
    effects = valve_at(state.coordinates, jnp.asarray(state.u)).effects
    if not effects:
        return ()
    jacobian = evidence.look(state.coordinates, state.u)[1]
    where: dict[int, list[int]] = {}
    for number in np.unique(evidence.condition):
        for k in not_known(state.coordinates, jacobian, evidence.condition != number):
            where.setdefault(k, []).append(int(number))
    return tuple(
        f"{capital(EFFECT_WORDS[effects[k].facts.id])} acts in the tests of "
        f"{_excitations(evidence, numbers)} alone. These were predicted without it, so that what "
        "it is worth there does not count as a gain on tests not seen."
        for k, numbers in where.items()
    )


def _excitations(evidence: Evidence, numbers: list[int]) -> str:
    loops = evidence.loops
    tests = [evidence.condition == n for n in numbers[:MOST]]
    told = [
        condition_words(
            float(np.median(loops.amplitude[t])), float(np.median(loops.frequency[t])), np.nan
        )
        for t in tests
    ]
    return listed(told)
