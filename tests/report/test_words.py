"""Words for effects, models and units, and amounts as engineers say them."""

from typing import get_args

import pytest

from sysid.diagnosis.result import Quantity
from sysid.diagnosis.words import (
    EFFECT_WORDS,
    FAMILY_WORDS,
    MODEL_WORDS,
    SHOWN_SYMBOLS,
    SHOWN_UNITS,
    amount,
    amount_beside_name,
    count,
    percent,
    plain,
)
from sysid.effects.base import Family
from sysid.effects.registry import EFFECTS
from sysid.identification.families import FAMILIES
from sysid.parameters import specs
from tests.report.made_diagnosis import (
    PLAY,
    quantity,
)


def test_words_are_complete():
    ids = {kind.facts.id for kind in EFFECTS}
    assert ids == set(EFFECT_WORDS)
    assert set(FAMILY_WORDS) == set(get_args(Family))
    assert set(MODEL_WORDS) == {f.name for f in FAMILIES}
    declared = [(s.symbol, s.unit) for kind in EFFECTS for s in specs(kind)]
    assert [d for d in declared if d[0] not in SHOWN_SYMBOLS and d[1] not in SHOWN_UNITS] == []
    assert set(SHOWN_SYMBOLS) <= {symbol for symbol, _ in declared}
    assert len(set(EFFECT_WORDS.values())) == len(EFFECT_WORDS)


@pytest.mark.parametrize(
    ("value", "told"),
    [(14.4, "14"), (9999.0, "9999"), (54_321.0, "54 000"), (999_400.0, "1 000 000"),
     (1_072_272.0, "1.1 million"), (12_174_107.0, "12 million")],
)  # fmt: skip
def test_large_numbers_are_told_as_people_say_them(value, told):
    assert count(value) == told


def test_amounts_in_engineers_units():
    assert amount(quantity(PLAY, "delta", 4.1e-4, 2e-5)) == "0.41 ± 0.02 mm"
    assert (
        amount(Quantity("beta_v", "", -5.2e-3, "1/K", 1e-4, -5.4e-3, -5e-3)) == "-0.52 ± 0.02 %/K"
    )
    assert amount(Quantity("tau_F", "", 5.1e-4, "s", 1e-5, 4.8e-4, 5.4e-4)) == "0.51 ± 0.03 ms"
    assert amount(Quantity("F_c", "", 41.3, "N", 1.0, 39.9, 42.7)) == "41.3 ± 1.4 N"
    assert amount(Quantity("q_F", "limit", 1e-3, "1/N", 1e-5, 0.98e-3, 1.02e-3)) == "1000 ± 20 N"
    lopsided = Quantity("m_f", "", 1.5, "kg", 0.2, 1.4, 2.2)
    assert amount(lopsided) == "1.5 kg (1.4 … 2.2 kg)"
    open_ = Quantity("n_g", "polytropic exponent", 1.2, "-", 9.0, -9.0, 9.0, identified=False)
    assert amount(open_) == "polytropic exponent not determined by these tests"
    assert amount_beside_name(open_) == "not determined by these tests"
    assert [plain(z) for z in (1834.0, 310.2, 0.0374, 9.96)] == ["1800", "310", "0.037", "10"]
    assert [percent(z) for z in (0.097, 1.2, 0.00037)] == ["9.7 %", "120 %", "0.037 %"]
