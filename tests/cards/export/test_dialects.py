"""Exported sources compile as their pages show it: with `cc` as it comes, in any dialect of C."""

import subprocess

import pytest

from sysid.cards.export.c_program import c_program
from sysid.cards.export.compiler import compiler
from sysid.cards.export.pieces import pieces_of
from tests.cards.example import example_card
from tests.cards.export.dampers import CASES, damper
from tests.cards.export.program import NAME, needs_compiler


@needs_compiler
@pytest.mark.parametrize("dialect", ["c99", "gnu99", "gnu17"])
def test_no_name_is_one_of_the_libraries_own(tmp_path, dialect):
    """Outside of strict C99 <math.h> declares more, and a source must not declare it again."""
    cc = compiler()
    assert cc is not None
    sources = []
    for case in CASES:
        folder = tmp_path / case
        folder.mkdir()
        for name, text in c_program(
            example_card(), pieces_of(damper(case), CASES[case][0]), NAME
        ).items():
            (folder / name).write_text(text, encoding="utf-8")
        sources.append(str(folder / f"{NAME}.c"))
    call = [cc, f"-std={dialect}", "-fsyntax-only", *sources]
    done = subprocess.run(call, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
