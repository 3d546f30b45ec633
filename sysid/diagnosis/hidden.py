"""Effects that a campaign cannot show, and the test that would show each."""

from typing import Final

import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.result import Invisible
from sysid.diagnosis.scores import Scored
from sysid.effects.registry import EFFECTS

_ABSORBED: Final = {
    "coil_lag": "at constant current it does nothing",
    "displacement_zero": "the base model does not depend on the place of the stroke",
}
_BY_HISTORY: Final = {
    "magnetic_hysteresis": "the order of the tests is not known",
    "run_drift": "the order of the tests is not known",
    "first_cycle_breakaway": "loops are means over steady cycles",
}
_SHOWN_BY: Final = {
    "load_cell_gain": "Calibrate with a dead weight or a second load cell",
    "residual_magnetism": "Degauss with a decaying alternating current and repeat a test at 0 A",
    "coil_lag": "Step the current at constant speed",
    "current_saturation": "Measure the current in the coil",
    "displacement_zero": "Move the centre of the stroke and repeat a test",
}


def hidden(evidence: Evidence, scores: tuple[Scored, ...]) -> tuple[Invisible, ...]:
    """What these tests cannot show: never to be read as absent.

    Args:
        evidence: The campaign.
        scores: Of the score test on the base model.
    """
    found = []
    dim = {c.effect.facts.id: c.survival for c in scores if not c.visible}
    warm = bool(np.isfinite(evidence.loops.temperature).all())
    for kind in EFFECTS:
        facts = kind.facts
        test = facts.separating_test
        test = _SHOWN_BY.get(facts.id, test[:1].upper() + test[1:])
        if facts.found_from == "invisible":
            because = _ABSORBED.get(facts.id, "the parameters of the base model absorb it")
        elif facts.family == "thermal" and not warm:
            because = "no temperature was recorded"
        elif facts.id in dim:
            share = 100.0 * dim[facts.id]
            because = f"the base model absorbs all but {share:.2g} % of its signature here"
        elif facts.id in _BY_HISTORY and (
            not evidence.history or facts.id == "first_cycle_breakaway"
        ):
            because = _BY_HISTORY[facts.id]
        else:
            continue
        found.append(Invisible(facts.id, because, test))
    return tuple(found)
