"""`campaign.toml`: everything of the contract is read, everything else is refused by line."""

import pytest

from sysid.data.manifest import read_manifest
from sysid.errors import ManifestError, SysidError

CONTRACT = """
[campaign]
name = "Example rig"
positive_force = "compression"
positive_displacement = "extension"
[files]
folder = "."
glob = "*.csv"
name = "{amplitude}mm{frequency}Hz_{current}A"
[columns]
time = { column = "t_s", unit = "s" }
displacement = { column = "x_mm", unit = "mm" }
force = { column = "F_N", unit = "N" }
[constants]
temperature = { value = 40, unit = "degC", sd = 10 }
[limits]
stroke = { value = 53, unit = "mm" }
velocity = { value = 1.0, unit = "m/s" }
current = { value = 1.0, unit = "A" }
"""


def test_the_contracts_example(tmp_path):
    path = tmp_path / "campaign.toml"
    path.write_text("\ufeff" + CONTRACT, encoding="utf-8")
    manifest = read_manifest(path)
    assert manifest.campaign.name == "Example rig"
    assert manifest.campaign.positive_displacement == "extension"
    assert manifest.naming().named["force"] == ("F_N", "N")
    assert manifest.constants.temperature is not None
    assert manifest.constants.temperature.sd == 10
    assert manifest.limits.stroke is not None
    assert manifest.limits.stroke.si("displacement") == pytest.approx(0.053)


def test_the_shipped_manifest_is_sound(utfsm_manifest):
    assert read_manifest(utfsm_manifest).files.name == "{amplitude}mm{frequency}Hz_{current}A"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[limits]", "[limit]", ("line 16", "'limit'", "Did you mean 'limits'")),
        ("stroke =", "strok =", ("line 17", "limits.strok", "stroke")),
        ('"mm" }\nforce', '"mm", to = 1 }\nforce', ("line 12", "columns.displacement.to")),
        ('"compression"', '"inward"', ("line 4", "'compression' or 'extension'", "inward")),
        ("value = 40", 'value = "40"', ("line 15", "constants.temperature.value", "'40'")),
        ("value = 40", "value = nan", ("line 15", "finite")),
        ("value = 40, ", "", ("line 15", "constants.temperature.value", "missing")),
        ("sd = 10", "sd = -1", ("line 15", "constants.temperature.sd", "greater than or equal")),
        ('"degC"', '"grad"', ("line 15", "'grad'", "degC, K, degF")),
        ('"F_N", unit = "N"', '"F_N", unit = "mm"', ("line 13", "'mm' is a unit of displacement")),
        ('"F_N"', '"x_mm"', ("line 13", "'x_mm'", "displacement and as force")),
        ("value = 53", "value = -53", ("line 17", "positive")),
        ("{amplitude}mm", "{amplitude}", ("line 9", "no unit stands behind")),
        ('glob = "*.csv"', "glob = 3", ("line 8", "files.glob", "string")),
        ('glob = "*.csv"', 'glob = "*.csv', ("not valid TOML", "line 8")),
        ("[files]", "[campaign]", ("not valid TOML", "line 6")),
    ],
)  # fmt: skip
def test_what_is_not_known_is_refused_with_its_line(tmp_path, old, new, words):
    assert old in CONTRACT
    path = tmp_path / "campaign.toml"
    path.write_text(CONTRACT.replace(old, new, 1))
    with pytest.raises(SysidError) as caught:
        read_manifest(path)
    for word in ("campaign.toml", *words):
        assert word in str(caught.value)


def test_a_manifest_that_is_not_text(tmp_path):
    (tmp_path / "campaign.toml").write_bytes(b"\xff\xfe\x00[")
    with pytest.raises(ManifestError, match="not UTF-8"):
        read_manifest(tmp_path / "campaign.toml")


def test_the_key_of_tests_may_be_any_column(tmp_path):
    """Also one whose header says a quantity: one test a current."""
    path = tmp_path / "campaign.toml"
    path.write_text('[columns]\ntest = { column = "current_A" }\n')
    assert read_manifest(path).naming().named["test"] == ("current_A", None)
