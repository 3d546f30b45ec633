"""Sentences on what has no name, or remains beside what has."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.sentences import sentences
from sysid.effects.registry import EFFECTS, make
from sysid.models.damper import Damper
from tests.report.made_diagnosis import (
    PLAY,
    backlash,
    inadequate,
    made,
    unknown,
)


def test_unknown_gives_its_signature():
    told = " ".join(sentences(unknown()))
    assert "No effect of the catalogue explains it." in told
    assert "83 % of the energy of the error that a better model could remove" in told
    assert "61 % of the energy of what remains returns its energy" in told
    assert "amplitude^1.0 · current^0.0" in told
    assert "frequency^" not in told  # it is not known
    assert "It varies with amplitude and current." in told
    assert "k_1e changed from test to test" in told
    assert "A spring that stiffens with travel would look like this." in told
    assert (
        "71 % of it is a function of position and acceleration (position 40 %, acceleration 30 %)"
    ) in told
    assert "Position and acceleration act together: 8.0 % of it is no sum" in told
    assert (
        "These tests hardly tell position from acceleration: alone they explain 60 % and 50 % of "
        "it, beside each other only 5.0 % and 2.0 % more."
    ) in told
    assert (
        "Proposed, not named: adding c·x|x| with c = 18560 ± 220 N/m^2 removes 40 % (± 5.9 %) and "
        "adding d with d = -12.3 ± 1.1 N removes a further 6.0 % (± 2.0 %) of what is left on "
        "conditions that were not used for choosing it."
    ) in told
    assert "Something acts that the catalogue lacks" in told


def test_what_repeats_itself_in_nothing_is_said_to():
    d = unknown()
    assert d.unknown.anova is not None
    nothing_found = replace(d.unknown.anova, explained=0.03)
    told = " ".join(sentences(made(unknown=replace(d.unknown, anova=nothing_found, proposal=()))))
    assert "It repeats itself in no function of position" in told
    assert "Proposed" not in told


@pytest.mark.parametrize(
    ("constant", "said"),
    [(0.3, "30 % of it is a constant force."), (0.0, "30 % of it is a function of several quant")],
)
def test_what_goes_with_no_one_quantity_is_said_to(constant, said):
    d = unknown()
    assert d.unknown.anova is not None
    few = tuple(replace(q, share=0.04) for q in d.unknown.anova.quantities)
    found = replace(d.unknown.anova, explained=0.3, constant=constant, quantities=few, pairs=())
    assert said in " ".join(sentences(made(unknown=replace(d.unknown, anova=found))))


def test_unknown_beside_a_name():
    rest = replace(unknown().unknown, share_of_reducible=0.2)
    told = " ".join(sentences(made(unknown=rest)))
    assert "the extended model is still" in told
    assert (
        "20 % of the energy of the error that a better model could remove remains and has no name."
        in told
    )


def test_what_remains_where_nothing_was_added_is_of_the_model():
    """A cause that the base model holds itself extends nothing."""
    d = backlash()
    cause = replace(d.causes[0], in_base=True)
    rest = replace(unknown().unknown, share_of_reducible=0.2)
    held = replace(unknown(), answer="named", causes=(cause,), unknown=rest, damper=d.base_damper)
    told = " ".join(sentences(held))
    assert " the model is still " in told
    assert "extended" not in told


def test_inadequate_names_the_bases_and_no_cause():
    told = " ".join(sentences(inadequate()))
    assert "29 % of the peak force (generalised hysteresis model, symmetric; 21 % with eff" in told
    assert "33 % of the peak force (Dahl model, full)" in told
    assert "No cause is named" in told
    assert "lost motion (backlash)" not in told


@pytest.mark.parametrize("count", [1, 2])
def test_what_remains_beside_a_proposal_is_what_the_proposed_effects_leave(count):
    """The base alone is far worse at one current; with the effects it is alike at all."""
    d = backlash()
    spring = make({k.facts.id: k for k in EFFECTS}["gas_spring"])
    before = d.loops.force * np.where(d.loops.current == 0.4, 1.9, 1.01)[:, None]
    base = replace(
        inadequate(), unknown=replace(unknown().unknown, share_of_reducible=0.4),
        simulated_before=before, simulated_after=before,
    )  # fmt: skip
    worst = "Relative to the peak force it is worst at 0.4 A"
    assert worst in " ".join(sentences(base)), "nothing was added: the base is what remains"
    proposed = replace(
        base, gain=d.gain, simulated_after=1.05 * d.loops.force,
        damper=Damper(d.damper.valve, (PLAY, spring)[:count]),
    )  # fmt: skip
    told = " ".join(sentences(proposed))
    effects = "the proposed effects" if count > 1 else "the proposed effect"
    assert f"Adding {effects} lowers the held-out error" in told
    assert f"Beside {effects}, at " in told
    assert re.search(
        r"the extended model is still [^.:]*(\.\d[^.:]*)*: 40 % of the energy of the error that a "
        r"better model could remove remains and has no name\.", told
    )  # fmt: skip
    assert "worst at" not in told
    assert "What has no name" not in told
