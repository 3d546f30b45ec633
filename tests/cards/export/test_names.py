"""Names and comments in exported sources."""

import pytest

from sysid.cards.export.identifier import ascii_text, comment, identifier
from sysid.cards.export.sources import without_unused


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
