"""A yield force at 0 A that rises with temperature is a class; one that falls is nothing."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.idle_yield import MEMBERS, idle_yield
from sysid.diagnosis.quantities import Values
from sysid.diagnosis.sentences import sentences
from sysid.effects.registry import effect_kind
from sysid.models.lumped import TABLE_1
from tests.data.loop_of import loops_of
from tests.report.made_diagnosis import nothing

SYMBOLS = tuple(s for s in TABLE_1 if s.startswith("F_y"))


def values(sd: float = 0.02, **changed: float) -> Values:
    """Table 1's yield forces, slopes known to `sd` N/K; at 40 °C they are known best."""
    at = {f"F_y[{k.replace('_', '.')} A].slope": z for k, z in changed.items()}
    table = np.array([at.get(s, TABLE_1[s]) for s in SYMBOLS])
    covariance = np.zeros((len(SYMBOLS), len(SYMBOLS)))
    for k, symbol in enumerate(SYMBOLS):
        if symbol.endswith("slope"):
            j = SYMBOLS.index(symbol.replace("slope", "intercept"))
            covariance[k, k] = sd**2
            covariance[j, j] = 1.0 + (40.0 * sd) ** 2
            covariance[j, k] = covariance[k, j] = -40.0 * sd**2
    return Values(SYMBOLS, table, covariance)


def two_tests(temperature: float) -> Loops:
    loops = loops_of(np.zeros((2, 72)), np.full(2, 5e-3), np.full(2, 4.0), np.zeros(2))
    return replace(loops, temperature=np.full(2, temperature))


def test_table_1_points_to_friction_or_remanence():
    found = idle_yield(values(), two_tests(75.0))
    assert found is not None
    assert (found.status, found.members) == ("class", MEMBERS)
    assert found.in_base
    level, slope = found.parameters
    assert level.symbol == effect_kind(MEMBERS[0]).facts.size, "the catalogue's"
    assert slope.value == pytest.approx(0.19)
    assert level.value == pytest.approx(41.0 + 40 * 0.19)
    assert level.sd == pytest.approx(1.0), "intercept and slope err together"
    assert found.extra_error == pytest.approx(41.0 + 75 * 0.19)
    assert found.separating_test is not None
    assert "Degauss" in found.separating_test
    assert found.confidence <= 0.9


@pytest.mark.parametrize(
    "told",
    [
        values(sd=0.2),
        values(**{"0": -0.19}),
        values(**{"0_2": 0.53}),
        Values(("F_0",), np.ones(1), np.eye(1)),
    ],
    ids=["not known well enough", "falls", "rises at another current too", "no table"],
)
def test_otherwise_it_is_nothing(told):
    assert idle_yield(told, two_tests(40.0)) is None


def test_it_is_told_as_an_engineer_would():
    cause = idle_yield(values(), two_tests(40.0))
    assert cause is not None
    told = " ".join(sentences(replace(nothing(), answer="class", causes=(cause,))))
    assert "At 0 A the yield force rises with temperature, by 0.19 ± 0.04 N/K" in told
    assert "either Coulomb friction of the seal or residual magnetism, which" in told
    assert "Adding it" not in told
