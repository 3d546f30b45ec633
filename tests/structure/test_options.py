"""Every option of every command, and every value that one chooses from, stands on some page."""

import re

import pytest
import typer.main

from sysid.cli.app import app
from sysid.cli.export import Format
from sysid.cli.fit import Kind
from sysid.cli.fit_order import Weighting
from sysid.cli.isolator import Controller, PlantKind
from sysid.cli.options import VARIANTS, Model
from tests.structure.pages import PAGES

COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]  # a click group
EVERYWHERE = {"--help", "--quiet", "--seed"}
"""They say all there is to say in `--help`."""
TEXT = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
OPTIONS = sorted(
    (name, option)
    for name, command in COMMANDS.items()
    for parameter in command.params
    for option in (*parameter.opts, *parameter.secondary_opts)
    if option.startswith("--") and option not in EVERYWHERE | {"--output"}
)
CHOICES = (Model, Weighting, Kind, Format, PlantKind, Controller)
VALUES = sorted(
    {str(value) for choice in CHOICES for value in choice}
    | {variant for variants in VARIANTS.values() for variant in variants}
)


@pytest.mark.parametrize(("command", "option"), OPTIONS)
def test_every_option_stands_on_a_page(command, option):
    assert re.search(rf"{option}(?![\w-])", TEXT), f"{option} of sysid {command}"


@pytest.mark.parametrize("value", VALUES)
def test_every_value_stands_on_a_page(value):
    assert re.search(rf"[`\s]{re.escape(value)}[`\s.,]", TEXT)
