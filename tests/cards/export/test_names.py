"""Names and comments in exported sources."""

import pytest

from sysid.cards.export.c_source import entries_of
from sysid.cards.export.identifier import ascii_text, comment, identifier
from sysid.cards.export.pieces import pieces_of
from sysid.cards.export.sources import without_unused
from sysid.errors import CardError
from sysid.models.damper import Damper
from tests.cards.export.dampers import effect, valve


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("RD-1005-3", "rd_1005_3"),
        ("8041", "damper_8041"),
        ("Dämpfer 2", "d_mpfer_2"),
        ("double", "double_"),
        ("...", "damper"),
    ],
)
def test_any_text_gives_a_name(text, name):
    assert identifier(text) == name
    assert identifier(name) == name


def test_a_name_cannot_end_a_comment_or_a_string():
    hostile = 'x */ int main(void) { system("rm"); } /* \\ \n "'
    assert "*/" not in ascii_text(hostile)
    assert '"' not in ascii_text(hostile)
    assert "\n" not in ascii_text(hostile)
    assert comment(hostile).count("*/") == 1


def test_what_nothing_uses_is_left_out():
    one = "static int a(void)\n{\n    return 1;\n}\n"
    two = "static int b(void)\n{\n    return a();\n}\n"
    text = f"{one}\n{two}\nint c(void) {{ return 2; }}\n"
    assert without_unused(text) == "int c(void) { return 2; }\n"
    assert without_unused(text.replace("return 2", "return b()")) == text.replace(
        "return 2", "return b()"
    )


def test_symbols_are_those_of_the_card_also_where_an_effect_is_there_twice():
    twice = tuple(effect("asymmetric_gain", turns=turns) for turns in ("velocity", "force"))
    pieces = pieces_of(Damper(valve("generalized"), twice), "generalized")
    symbols = [entry.symbol for entry in entries_of(pieces)]
    assert len(set(symbols)) == len(symbols)
    assert {"asymmetric_gain.g_a", "asymmetric_gain-2.g_a"} <= set(symbols)


@pytest.mark.parametrize(("id", "symbol"), [("force_delay", "tau_F"), ("velocity_delay", "tau_v")])
def test_what_is_still_to_come_cannot_be_exported(id, symbol):
    early = Damper(valve("generalized"), (effect(id, **{symbol: -5e-4}),))
    with pytest.raises(CardError, match=f"{id} cannot be exported: {symbol} is negative"):
        pieces_of(early, "generalized")
    pieces_of(Damper(valve("generalized"), (effect(id),)), "generalized")
