import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from sysid.cards.write import write_card
from sysid.cli.app import run
from tests.cards.example import example_card


@dataclass(frozen=True)
class Said:
    """What a command answered."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@pytest.fixture(autouse=True, scope="session")
def _width():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "160")
        yield


@pytest.fixture
def sysid(capsys) -> Callable[..., Said]:
    """Run a command in this process; fits draw from a posterior only where a test says so."""

    def call(*arguments: object) -> Said:
        words = [str(a) for a in arguments]
        if words[:1] == ["fit"] and not any("posterior" in word for word in words):
            words.append("--no-posterior")
        capsys.readouterr()
        code = run(words)
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err
        assert "\x1b" not in said.out + said.err
        return Said(code, said.out, said.err)

    return call


@pytest.fixture
def card_file(tmp_path) -> Path:
    path = tmp_path / "card.json"
    write_card(example_card(), path)
    return path
