"""Sentences say what the numbers say; every number has its unit."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.result import Invisible, Quantity, ScreenRow
from sysid.diagnosis.sentences import sentences
from sysid.diagnosis.words import (
    percent,
)
from sysid.effects.registry import EFFECTS, make
from sysid.models.damper import Damper
from sysid.models.tanh_kwok import TanhKwok
from sysid.parameters import as_dict, build
from tests.models.rival_examples import example
from tests.report.made_diagnosis import (
    PLAY,
    backlash,
    inadequate,
    made,
    nothing,
    unknown,
)

ANSWERS = {"named": backlash, "nothing": nothing, "unknown": unknown, "inadequate": inadequate}


def test_a_name_with_place_sign_size_and_gain():
    d = backlash()
    first, _, gain, beyond, invisible = sentences(d)
    error = d.simulated_before - d.simulated_after
    k = int(np.argmax(np.mean(error**2, axis=1)))
    a, f, i = 1e3 * d.loops.amplitude[k], d.loops.frequency[k], d.loops.current[k]
    peak = np.abs(error[k]).max()
    assert first.startswith(f"At {a:g} mm, {f:g} Hz and {i:g} A the model is wrong by up to ")
    assert float(re.search(r"up to (\d+) N for", first)[1]) == pytest.approx(peak, rel=0.05)
    assert "after each reversal" in first
    assert "grows with frequency" in first
    assert first.endswith(": lost motion (backlash), 0.41 ± 0.02 mm (confidence 97 %).")
    travel = float(re.search(r"for ([\d.]+) mm after", first)[1])
    step = a * np.sin(np.arccos(1 - 0.41 / a)) * 2 * np.pi / d.loops.force.shape[1]
    assert 0.3 <= travel <= 0.41 + step, "the play, and the step of the grid in which it ends"
    assert gain.startswith(
        f"Adding it lowers the held-out error from {percent(d.gain.before)} to "
        f"{percent(d.gain.after)} of the peak force; repeatability is "
        f"{percent(d.gain.repeatability)}. That is 95 % (95 % interval 93 % to 97 %)"
    )
    assert "the largest amplitude: 12 % before, 3.1 % after" in beyond
    assert invisible == (
        "These tests cannot show, and so do not exclude, a gain error of the load cell or lag of "
        "the coil current: each needs a test of its own."
    )


def test_static_forces_of_the_base_are_told_with_their_values():
    """f_0 and k of a base model are what the catalogue calls an offset and a gas spring."""
    valve = build(TanhKwok, as_dict(example("tanh")) | {"f_0": 48.0, "k": 800.0})
    symbols = tuple(as_dict(valve))
    sd = {"f_0": 2.0, "k": 50.0}
    held = made(
        answer="unknown", causes=(), symbols=symbols, values=np.array([*as_dict(valve).values()]),
        covariance=np.diag([sd.get(s, 0.0) ** 2 for s in symbols]), damper=Damper(valve),
        base=replace(backlash().base, model="tanh", variant="full"),
        invisible=(
            Invisible("force_offset", "absorbed", "-"), Invisible("coil_lag", "constant", "-"),
        ),
    )  # fmt: skip
    *_, told, invisible = sentences(held)
    assert told == (
        "The base model itself holds a static force of 48 ± 4 N (gas preload or load-cell "
        "zero) and a stiffness of 0.80 ± 0.10 kN/m (gas spring)."
    )
    assert invisible.startswith("These tests cannot show, and so do not exclude, lag of the coil")
    vague = np.where(np.array(symbols) == "k", 500.0**2, np.diagonal(held.covariance))
    *_, told, _ = sentences(replace(held, covariance=np.diag(vague)))
    assert "48 ± 4 N" in told
    assert "stiffness" not in told, "what the tests do not determine is not told"


def test_a_class_says_what_would_tell():
    cause = replace(
        backlash().causes[0], status="class", members=("backlash", "entrained_air"),
        separating_test="the smallest amplitude, with and without a preload on the rod",
    )  # fmt: skip
    told = sentences(made(answer="class", causes=(cause,)))
    assert told[0].endswith(
        ": either lost motion (backlash), in that case with 0.41 ± 0.02 mm, or lost motion on one "
        "side (entrained air or cavitation), which these tests cannot tell apart (confidence 97 %)."
    )
    assert "Not excluded: lost motion on one side (entrained air or cavitation)." in told
    assert (
        "This would tell them apart: the smallest amplitude, with and without a preload on the rod."
        in told
    )


def test_of_several_classes_each_says_what_its_members_stand_for():
    play = replace(
        backlash().causes[0], status="class", members=("backlash", "entrained_air"),
        separating_test="the smallest amplitude",
    )  # fmt: skip
    spring = replace(play, id="gas_spring", members=("gas_spring", "bump_stop"))
    told = sentences(made(answer="class", causes=(play, spring)))
    assert (
        "Not excluded instead of lost motion (backlash): lost motion on one side (entrained air or "
        "cavitation)."
    ) in told
    assert "Not excluded instead of a gas spring: a stop near the end of the stroke." in told


STRIBECK = (
    Quantity("F_st", "Stribeck friction", 92.0, "N", 2.5, 87.0, 97.0),
    Quantity("v_st", "Stribeck speed", 2.29e-3, "m/s", 1e-5, 2.27e-3, 2.31e-3),
)


VAGUE = Quantity("k_st", "stiffness before sliding", 1e6, "N/m", 1e9, 0.0, 1e9, identified=False)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        (STRIBECK, "92 ± 5 N and Stribeck speed 2.29 ± 0.02 mm/s"),
        (
            (*STRIBECK, VAGUE),
            "92 ± 5 N and Stribeck speed 2.29 ± 0.02 mm/s, stiffness before sliding not determined "
            "by these tests",
        ),
        (
            (replace(STRIBECK[1], identified=False), VAGUE),
            "Stribeck speed and stiffness before sliding not determined by these tests",
        ),
    ],
    ids=["all determined", "one is not", "none is"],
)
def test_parameters_that_are_not_determined_are_said_to_be(parameters, told):
    cause = replace(
        backlash().causes[0], id="stribeck_friction", members=("stribeck_friction",),
        parameters=parameters,
    )  # fmt: skip
    assert sentences(made(causes=(cause,)))[0].endswith(
        f": Stribeck friction, {told} (confidence 97 %), with 1 further effect that is not "
        "asserted."
    )
    several = replace(cause, status="class", members=(*cause.members, "presliding_friction"))
    assert (
        f"either Stribeck friction, in that case with {told}, or friction with a presliding "
        "spring, which these tests cannot tell apart"
    ) in sentences(made(causes=(several,)))[0]


def test_effects_that_are_not_asserted_have_their_part_in_the_headline():
    """The place and size told are those of all that the extended model adds."""
    d = backlash()
    spring, stop = (
        make({k.facts.id: k for k in EFFECTS}[id]) for id in ("gas_spring", "bump_stop")
    )
    alone, one, two = (
        sentences(replace(d, damper=Damper(d.damper.valve, (PLAY, *more))))[0]
        for more in ((), (spring,), (spring, stop))
    )
    assert alone.endswith("0.41 ± 0.02 mm (confidence 97 %).")
    assert one.endswith("(confidence 97 %), with 1 further effect that is not asserted.")
    assert two.endswith("(confidence 97 %), with 2 further effects that are not asserted.")
    causes = d.causes[0], replace(d.causes[0], id="gas_spring", members=("gas_spring",))
    both = replace(d, damper=Damper(d.damper.valve, (PLAY, spring, stop)), causes=causes)
    assert sentences(both)[0].endswith(
        "2 causes were found, and 1 further effect that is not asserted."
    )


def test_an_offset_that_friction_in_one_direction_explains_is_a_member_of_its_class():
    d = backlash()
    offset = make({k.facts.id: k for k in EFFECTS}["force_offset"])
    cause = replace(d.causes[0], status="class", members=("backlash", "force_offset"))
    held = replace(d, damper=Damper(d.damper.valve, (PLAY, offset)), causes=(cause,))
    assert "not asserted" not in sentences(held)[0]


def test_an_effect_that_lowers_no_error_is_not_said_to_remove_any():
    """What it adds had been put elsewhere: its likelihood speaks for it, its share does not."""
    one = backlash().causes[0]
    causes = replace(one, share=0.93), replace(one, share=0.0, extra_error=48.0)
    _, first, second, *_ = sentences(made(causes=causes))
    assert first.endswith("and removes 93 % of what all effects together remove.")
    assert second.endswith(
        "it adds 48 N RMS over all tests, for which other parts of the model stood in without it."
    )


def test_a_family_has_no_name():
    cause = replace(backlash().causes[0], status="family", id=None, members=("backlash",))
    told = sentences(made(answer="family", causes=(cause,)))
    assert "Nearest of the kind 'lost motion': lost motion (backlash)." in told
    first = told[0]
    assert "'lost motion'" in first
    assert "no single name" in first
    assert "backlash" not in first
    assert "mm (conf" not in first


def test_two_causes_are_told_one_by_one():
    one = backlash().causes[0]
    other = replace(one, id="gas_spring", members=("gas_spring",), extra_error=17.4, share=0.21)
    other = replace(other, parameters=(Quantity("k_g", "", 1850.0, "N/m", 30.0, 1790.0, 1910.0),))
    told = sentences(made(causes=(one, other)))
    assert told[0].endswith("2 causes were found.")
    assert told[1].startswith("Lost motion (backlash), 0.41 ± 0.02 mm")
    assert told[2] == (
        "A gas spring, 1.85 ± 0.06 kN/m (confidence 97 %); it adds 17 N RMS over all tests and "
        "removes 21 % of what all effects together remove."
    )
    assert any(s.startswith("Adding them lowers") for s in told)


def test_a_gain_that_is_none_is_not_called_one():
    gain = replace(backlash().gain, before=0.03, after=0.031, reducible_explained=float("nan"))
    told = sentences(made(gain=gain))
    assert any(
        s.startswith("Adding it does not lower the held-out error: it goes from 3.0 % to 3.1 %")
        for s in told
    )
    assert not any("That is" in s for s in told)


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [
        (0.18, 0.95, " (95 % interval 18 % to 95 %)"),
        (0.18, 1.4, " (95 % interval: at least 18 %)"),
        (-0.3, 1.4, " (95 % interval: anything from nothing to all of it)"),
        (-0.3, 0.4, " (95 % interval -30 % to 40 %)"),
        (float("nan"), float("nan"), ""),
    ],
)
def test_no_more_than_all_of_the_error_can_be_removed(low, high, told):
    gain = replace(backlash().gain, low=low, high=high)
    words = " ".join(sentences(made(gain=gain)))
    assert f"That is 95 %{told} of the error that a better model could remove." in words


def test_nothing_says_within_what_and_what_would_have_shown():
    screen = (
        ScreenRow("force_clipping", 9.0, 16.0, 0.4, 1.0, 1e-4),
        ScreenRow("backlash", 8.0, 16.0, 0.4, 1.0, 1e-5),
        ScreenRow("gas_spring", 7.0, 16.0, 0.4, 1.0, 25.0),
        ScreenRow("seal_friction", 0.0, 16.0, 1e-4, float("nan"), float("nan")),
    )
    first, seen, *_ = sentences(replace(nothing(), screen=screen))
    assert first.startswith(
        "These tests do not contradict the generalised hysteresis model (symmetric) within 1.2 % "
        "of the peak force"
    )
    assert "repeatability is 0.74 %" in first
    assert seen == (
        "They would have shown, in four cases of five, for example lost motion (backlash) from "
        "0.057 mm or a gas spring from 0.14 kN/m."
    )  # √24 + 0.84 = 5.74 standard errors each


def test_a_cause_that_rests_on_some_of_the_tests_is_said_to():
    cause = backlash().causes[0]
    (steady, unsteady) = (
        " ".join(sentences(made(causes=(replace(cause, stability=share),))))
        for share in (0.96, 0.6)
    )
    assert "Only 60 % of random halves of the conditions come to lost motion" in unsteady
    assert "halves" not in steady
    few = " ".join(sentences(made(causes=(replace(cause, stability=float("nan")),))))
    assert "So few amplitudes and frequencies cannot be halved" in few
    assert "halved" not in steady + unsteady


@pytest.mark.parametrize("answer", sorted(ANSWERS))
def test_every_number_has_its_unit(answer):
    unit = r"(N( RMS)?|kN/m|N/K|mm|Hz|A|%|% \(|± [\d.]+ mm)"
    for sentence in sentences(ANSWERS[answer]()):
        if "score" in sentence:
            continue  # given by the diagnosis itself
        bare = re.sub(r"k_1e|\^-?[\d.]+", "", sentence)
        for found in re.finditer(r"\d+(\.\d+)?", bare):
            assert re.match(rf"\s{unit}", bare[found.end() :]) or bare[found.end() :].startswith(
                " ± "
            ), (sentence, found[0])
        assert sentence.endswith(".")
        assert "nan" not in sentence
        assert "e+" not in sentence
