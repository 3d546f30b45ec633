"""Effects that a campaign cannot show, and the test that would show each."""

from collections.abc import Collection
from typing import Final

import numpy as np

from sysid.diagnosis.cycle_evidence import FEWEST_CYCLES
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.prototypes import NEED_CYCLES, Magnitudes, magnitude
from sysid.diagnosis.result import Invisible
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.tied import (
    OF_FREQUENCY,
    OF_SPEED,
    frequency_is_tied,
    frequency_is_varied,
    one_frequency,
    untying_words,
)
from sysid.diagnosis.warmth import tell_temperatures, warmth_unseen, warmth_untold
from sysid.diagnosis.within_tests import FEWEST_TESTS, Within
from sysid.diagnosis.words import capital, percent
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS
from sysid.parameters import specs

_ABSORBED: Final = {
    "coil_lag": "at constant current it does nothing",
    "displacement_zero": "the base model does not depend on the place of the stroke",
}
_BY_HISTORY: Final = {
    "magnetic_hysteresis": "the order of the tests is not known",
    "run_drift": "the order of the tests is not known",
    "surface_temperature": "the order of the tests, and so what they heated, is not known",
}
_FAR_OFF: Final = "the base model is too far off to look for what the order of the tests does"
OF_ONE: Final = frozenset((*OF_FREQUENCY, *OF_SPEED))
"""Laws that are one where frequency is tied to speed."""
_TIED: Final = (
    "every speed comes with a frequency of its own here, so that a law of frequency cannot be told "
    "from a law of speed"
)
_NOTHING: Final = 1e-6
"""Share of a signature that survives by rounding, or by solvers that stop."""
_SHOWN_BY: Final = {
    "load_cell_gain": "Calibrate with a dead weight or a second load cell",
    "residual_magnetism": "Degauss with a decaying alternating current and repeat a test at 0 A",
    "coil_lag": "Step the current at constant speed",
    "current_saturation": "Measure the current in the coil",
    "displacement_zero": "Move the centre of the stroke and repeat a test",
}


def hidden(
    evidence: Evidence,
    scores: tuple[Scored, ...],
    within: Within,
    asserted: Collection[str] = (),
) -> tuple[Invisible, ...]:
    """What these tests cannot show: never to be read as absent.

    Args:
        evidence: The campaign.
        scores: Of the score test on the base model.
        within: What the cycles of the tests say.
        asserted: Ids of all members of the causes.
    """
    found = []
    tied = OF_ONE.isdisjoint(asserted) and frequency_is_tied(evidence.loops)
    dim = {c.effect.facts.id: c.survival for c in scores if not c.visible}
    looked_for = {c.effect.facts.id for c in scores}
    warm = evidence.loops.temperature
    unseen, untold = warmth_unseen(warm), warmth_untold(warm)
    for kind in EFFECTS:
        facts, absorbed = kind.facts, False
        test = facts.separating_test
        test = _SHOWN_BY.get(facts.id, capital(test))
        if facts.found_from == "invisible":
            because = _ABSORBED.get(facts.id, "the parameters of the base model absorb it")
        elif facts.id in NEED_CYCLES:
            because = _in_cycles(kind, within, evidence.size)
            if because is None:
                continue
        elif facts.of_temperature and unseen is not None:
            because, test = unseen, tell_temperatures(warm, evidence.loops.ids) or test
        elif facts.id == "surface_temperature" and untold is not None:
            because, test = untold, tell_temperatures(warm, evidence.loops.ids) or test
        elif facts.id in OF_FREQUENCY and not frequency_is_varied(evidence.loops):
            because = one_frequency(evidence.loops)
            test = f"Repeat {untying_words(evidence.loops)}"
        elif facts.id in OF_FREQUENCY and tied:
            because, absorbed = _TIED, facts.id in dim
            test = f"Repeat {untying_words(evidence.loops)}"
        elif facts.id in dim:
            because, absorbed = _absorbed(dim[facts.id]), True
        elif facts.id in _BY_HISTORY and facts.id not in looked_for:
            because = _FAR_OFF if evidence.history is not None else _BY_HISTORY[facts.id]
        else:
            continue
        found.append(Invisible(facts.id, because, test, absorbed))
    return tuple(found)


def _absorbed(survival: float) -> str:
    if survival < _NOTHING:
        return "the base model absorbs it wholly here"
    return f"the base model absorbs all but {percent(survival)} of its signature here"


def _in_cycles(kind: type[AbstractEffect], within: Within, size: Magnitudes) -> str | None:
    """Why the cycles of the tests do not show an effect; None where they would have."""
    facts = kind.facts
    row = next((r for r in within.screen if r.id == facts.id), None)
    if row is None:
        return (
            f"{within.tests} of the tests have {FEWEST_CYCLES} different cycles or more, and "
            f"{FEWEST_TESTS} are needed"
        )
    if facts.id in within.members:
        return None
    if within.unnamed is not None:
        return f"the force changes from cycle to cycle like {within.unnamed}, which would cover it"
    unit = next(s.unit for s in specs(kind) if s.symbol == facts.size)
    realistic = facts.realistic[facts.size][1] * magnitude(unit, size)
    if np.sqrt(row.threshold) * row.se > realistic:
        return "the cycles of a test scatter by more than it would change them"
    return None
