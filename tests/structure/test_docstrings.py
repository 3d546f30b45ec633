"""Every public thing tells what its user must know; and a thing that does not is found."""

from pathlib import Path
from typing import Final

import pytest

import sysid
from sysid.effects.registry import EFFECTS
from sysid.identification.families import FAMILIES
from tests.structure.docstring_rules import faults_of, package

NEEDS_NONE: Final[dict[tuple[str, str], str]] = {
    (f"sysid.cli.{name}.{name}", "raises"): (
        "the docstring of a command is its help text; that errors are exit codes stands in cli/app"
    )
    for name in ("compare", "diagnose", "validate")
}
"""(name, rule) → why the rule does not fit."""


def test_public_things_tell_what_their_user_must_know():
    found = faults_of(package(Path(sysid.__file__).parent))
    left = [fault for fault in found if (fault.name, fault.rule) not in NEEDS_NONE]
    assert not left, "\n".join(f"{fault.rule}: {fault}" for fault in left)
    unused = NEEDS_NONE.keys() - {(fault.name, fault.rule) for fault in found}
    assert not unused, "exceptions that nothing needs any more"


def test_every_effect_and_valve_is_looked_at_for_its_source():
    """Without their sources all of them are found, and nothing else."""
    sources = package(Path(sysid.__file__).parent)
    bare = {
        name: text.replace("Source:", "Note:")
        for name, text in sources.items()
        if name.startswith(("sysid.effects", "sysid.models"))
    }
    found = {fault.name.rpartition(".")[2] for fault in faults_of(bare) if fault.rule == "source"}
    wanted = {kind.__name__ for kind in EFFECTS} | {f.valve.__name__ for f in FAMILIES}
    assert found == wanted


GOOD = '''
"""A module."""
from dataclasses import dataclass
import numpy as np
from jaxtyping import Float
Samples = Float[np.ndarray, " n"]

@dataclass(frozen=True)
class Loop:
    """A loop.

    Attributes:
        force: [n] N.
        velocity: m/s.
        index: [n] places.
    """
    force: np.ndarray
    velocity: Samples
    index: np.ndarray

    def peak_force(self) -> float:
        """The largest force, N."""
        return 1.0

class AbstractThing:
    """Something.

    """
    def act(self, force: float) -> np.ndarray:
        """What it does, [n].

        Args:
            force: N.

        Raises:
            ValueError: The force is negative.
        """
        if force < 0:
            raise ValueError("negative")
        try:
            raise KeyError("caught here")
        except KeyError:
            return np.zeros(1)

class Thing(AbstractThing):
    """One of them."""
    def act(self, force: float) -> np.ndarray:
        return np.zeros(1)

class GasSpring(AbstractForceEffect):
    """A spring.

    Source:
        A gas.
    """

def _private(force): ...
'''


def rules(text: str, name: str = "made.module") -> list[tuple[str, str]]:
    return [(fault.rule, fault.name.removeprefix("made.")) for fault in faults_of({name: text})]


def test_what_is_told_is_not_complained_of():
    assert rules(GOOD) == []


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('"""A module."""', "", ("docstring", "module")),
        ('"""One of them."""', "pass", ("docstring", "module.Thing")),
        ('"""The largest force, N."""', "", ("docstring", "module.Loop.peak_force")),
        ("force: [n] N.", "force: N.", ("shape", "module.Loop")),
        ("force: [n] N.", "force: [n] of the test.", ("unit", "module.Loop")),
        ("velocity: m/s.", "velocity: Of the test.", ("unit", "module.Loop")),
        ("        index: [n] places.\n", "", ("shape", "module.Loop")),
        ("What it does, [n].", "What it does.", ("shape", "module.AbstractThing.act")),
        ("            force: N.", "            force: A large one.",
         ("unit", "module.AbstractThing.act")),
        ("ValueError: The force", "KeyError: The force", ("raises", "module.AbstractThing.act")),
        ("except KeyError:", "except OSError:", ("raises", "module.AbstractThing.act")),
        ("        return np.zeros(1)\n\nclass Gas", "        raise OSError\n\nclass Gas",
         ("raises", "module.Thing.act")),
        ("class Thing(AbstractThing)", "class Thing", ("docstring", "module.Thing.act")),
        ("        A gas.\n", "", ("source", "module.GasSpring")),
    ],
)  # fmt: skip
def test_what_is_not_told_is_found(old, new, fault):
    assert GOOD.count(old) == 1
    assert fault in rules(GOOD.replace(old, new))


def test_a_line_of_shapes_holds_for_a_module_and_for_a_class():
    without = GOOD.replace("[n] ", "").replace(", [n].", ".")
    assert {rule for rule, _ in rules(without)} == {"shape"}
    line = '"""A module.\n\nShapes: all arrays are [n].\n"""'
    assert rules(without.replace('"""A module."""', line)) == []
    line = "A loop.\n\n    Shapes: all arrays are [n].\n"
    assert {name for _, name in rules(without.replace("A loop.\n", line))} == {
        "module.AbstractThing.act"
    }


def test_private_modules_are_not_looked_at():
    assert rules("x = 1", "made._module") == []
    assert rules("x = 1") == [("docstring", "module")]
