"""The Modelica package: its text read by another parser, its C called as a Modelica tool would."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from sysid.cards.export.compiler import compiler
from sysid.cards.export.modelica import modelica_package
from sysid.cards.export.pieces import pieces_of
from tests.cards.example import example_card
from tests.cards.export.dampers import CASES, damper
from tests.cards.export.program import NAME, Program, needs_compiler, random_rows

HOST = """
#include <stdio.h>
#include "NAME_modelica.h"

int main(void)
{
    void *memory = NAME_modelica_open();
    double t, x, v, i, T;
    while (scanf("%lf %lf %lf %lf %lf", &t, &x, &v, &i, &T) == 5)
        printf("%.17g\\n", NAME_modelica_force(memory, t, x, v, i, T));
    NAME_modelica_close(memory);
    return 0;
}
"""
"""What a Modelica tool makes of the package's external functions."""
FAULTS = {
    "a semicolon": (";\n    end constructor", "\n    end constructor"),
    "the end of a class": ("end Memory;", ""),
    "then": ("when sample(0, interval) then", "when sample(0, interval)"),
    "a quotation mark": ('"Force at the next sample"', '"Force at the next sample'),
    "a letter": ("model Example", "model Exampl"),
}


def package(case: str, name: str = NAME) -> dict[str, str]:
    return modelica_package(example_card(), pieces_of(damper(case), CASES[case][0]), name)


def host_of(case: str, name: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Compile what a Modelica tool would call."""
    for file, text in {**package(case, name), "host.c": HOST.replace("NAME", name)}.items():
        (folder / file).write_text(text, encoding="utf-8")
    cc = compiler()
    assert cc is not None
    return subprocess.run(
        [cc, "-std=c99", "-O1", "host.c", "-o", "host", "-lm"],
        cwd=folder, capture_output=True, text=True,
    )  # fmt: skip


def complaints(text: str) -> list[str]:
    """What the parser calls an error."""
    rumoca = pytest.importorskip("rumoca", reason="there is no Modelica parser here (rumoca)")
    return [str(d) for d in rumoca.validate_source(text) if " error:" in str(d)]


@pytest.mark.parametrize("case", CASES)
def test_package_is_modelica(case):
    assert not complaints(package(case)["Unit.mo"])


@pytest.mark.parametrize("lacking", FAULTS)
def test_parser_finds_what_is_lacking(lacking):
    text, (whole, broken) = package("forces")["Unit.mo"], FAULTS[lacking]
    assert whole in text
    assert complaints(text.replace(whole, broken, 1))


@needs_compiler
@pytest.mark.parametrize("case", CASES)
def test_external_functions_give_the_program_s_force(case, tmp_path: Path):
    built = host_of(case, NAME, tmp_path)
    assert built.returncode == 0, built.stderr[-2000:]
    rows = random_rows(300)
    told = "\n".join(" ".join(f"{z:.17g}" for z in row) for row in np.delete(rows, 3, axis=1))
    said = subprocess.run(
        [str(tmp_path / "host")], input=told, capture_output=True, text=True, check=True
    )
    force, _ = Program(CASES[case][0], damper(case), tmp_path).run(rows)
    assert np.ptp(force) > 100.0
    np.testing.assert_allclose(np.array(said.stdout.split(), float), force, rtol=1e-12, atol=1e-9)


@needs_compiler
@pytest.mark.parametrize(
    ("case", "name"),
    [("forces", "generalized"), ("carreau", "carreau"), ("forces", "asymmetric_gain"),
     ("forces", "sample"), ("forces", "plant")],
)  # fmt: skip
def test_no_name_of_a_package_is_one_of_the_program_s_own(case, name, tmp_path: Path):
    built = host_of(case, name, tmp_path)
    assert built.returncode == 0, built.stderr[-2000:]
