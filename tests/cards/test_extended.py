"""The card of a diagnosis: the extended model, with what is not sure about it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import stdtrit

from sysid.cards.extended import card_of_diagnosis
from sysid.cards.read import parse_card
from sysid.cards.schema import Card
from sysid.cards.verify import verify
from sysid.cards.write import card_text
from sysid.data.record import Record, Source
from sysid.diagnosis.result import Diagnosis
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import effect_kind, make
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.parameters import specs
from tests.data.synthetic import make_record
from tests.report.made_diagnosis import VALVE, backlash, made, nothing, quantity


def records() -> tuple[Record, ...]:
    """One of the diagnosed tests, and one that was left out."""
    names = (backlash().loops.ids[0], "another")
    return tuple(replace(make_record(), id=n, source=Source(f"{n}.csv", "0" * 64)) for n in names)


def card_of(diagnosis: Diagnosis) -> Card:
    return card_of_diagnosis(diagnosis, records(), damper="D", campaign="C", remarks=("A remark.",))


def found(*effects: AbstractEffect, **changes: object) -> Diagnosis:
    """A diagnosis that found some effects on the same base; each cause states their intervals."""
    base = backlash()
    damper = Damper(VALVE, effects)
    causes = []
    for k, effect in enumerate(effects):
        stated = [
            quantity(effect, s.symbol, v := effect.facts.nominal[s.symbol], 0.1 * (k + 1) * abs(v))
            for s in specs(effect)
        ]
        causes.append(
            replace(
                base.causes[0], id=effect.facts.id, members=(effect.facts.id,), effect=effect,
                family=effect.facts.family, parameters=tuple(stated),
            )
        )  # fmt: skip
    own = [(e, s) for e in effects for s in specs(e)]
    symbols = (*base.symbols[: len(specs(VALVE))], *(f"{e.facts.id}.{s.symbol}" for e, s in own))
    values = [*base.values[: len(specs(VALVE))], *(getattr(e, s.symbol) for e, s in own)]
    return made(
        damper=damper, causes=tuple(reversed(causes)), symbols=symbols,
        values=np.array(values, dtype=float), covariance=1e-12 * np.eye(len(symbols)),
        simulated_after=np.asarray(simulate(damper, loop_motion(base.loops))), **changes,
    )  # fmt: skip


def test_the_card_simulates_what_the_diagnosis_did():
    diagnosis = backlash()
    text = card_text(card_of(diagnosis))
    damper = verify(parse_card(text, where="card.json"))
    force = np.asarray(simulate(damper, loop_motion(diagnosis.loops)))
    largest = np.abs(force).max()
    np.testing.assert_allclose(force, diagnosis.simulated_after, rtol=0.0, atol=1e-9 * largest)
    assert card_text(card_of(diagnosis)) == text


def test_quality_validity_and_files():
    diagnosis = backlash()
    card = card_of(diagnosis)
    error = np.sqrt(np.mean((diagnosis.simulated_after - diagnosis.loops.force) ** 2, axis=1))
    peak = np.abs(diagnosis.loops.force).max(axis=1)
    assert diagnosis.gain is not None
    assert card.quality.mean_nrmse == pytest.approx(np.mean(error / peak), rel=1e-12)
    assert card.quality.held_out_mean_nrmse == diagnosis.gain.after
    assert card.quality.noise_floor_nrmse == pytest.approx(np.mean(4.0 / peak), rel=1e-12)
    of_mean = 4.0 / np.sqrt(diagnosis.loops.cycles) / peak
    assert card.quality.mean_cycle_noise_nrmse == pytest.approx(np.mean(of_mean), rel=1e-12)
    assert card.validity.amplitude == (2.5e-3, 25e-3)
    assert card.validity.current == (0.0, 0.4)
    assert [d.file for d in card.data] == [f"{diagnosis.loops.ids[0]}.csv"]
    assert (card.model, card.variant, card.weights) == ("generalized", "symmetric", "paper")


def test_intervals_belong_to_the_values_beside_them_in_the_order_of_the_damper():
    """The causes' own are those of another fit: a value might lie outside of them."""
    kind = effect_kind("frequency_law")
    effects = (
        make(kind, choice={"part": "yield"}),
        make(effect_kind("gas_spring")),
        make(kind, choice={"part": "whole"}),
    )
    diagnosis = found(*effects)
    variance = np.diagonal(diagnosis.covariance).copy()
    variance[-3:] = np.array([1e-3, 2e-3, 3e-3]) ** 2
    card = card_of(replace(diagnosis, covariance=np.diag(variance), interval="by hand"))
    assert card.interval == "0.95, by hand"
    assert [e.id for e in card.effects] == ["frequency_law", "gas_spring", "frequency_law"]
    assert [e.choice for e in card.effects] == [{"part": "yield"}, {}, {"part": "whole"}]
    shown = [p for e in card.effects for p in e.parameters]
    symbols = [p.symbol for p in shown]
    assert symbols == ["frequency_law.eps_f", "gas_spring.k_g", "frequency_law-2.eps_f"]
    for k, p in enumerate(shown):
        place = card.covariance.symbols.index(p.symbol)
        assert p.sd == pytest.approx(np.sqrt(card.covariance.matrix[place][place]))
        assert p.sd == pytest.approx((k + 1) * 1e-3)
        assert p.high - p.value == pytest.approx(p.value - p.low)
        assert p.high - p.value == pytest.approx(stdtrit(5, 0.975) * p.sd), "six conditions"
    assert set(symbols) <= set(card.covariance.symbols)
    assert card.parameters[0].sd == pytest.approx(1e-6)
    assert verify(card).effects[1].facts.id == "gas_spring"


def test_what_is_not_sure_is_a_known_discrepancy():
    gas = make(effect_kind("gas_spring"))

    def told(**changes: object) -> str:
        plain = found(gas)
        cause = replace(plain.causes[0], **changes)  # pyright: ignore[reportArgumentType]
        return "\n".join(card_of(replace(plain, causes=(cause,))).known_discrepancies)

    named = told()
    assert "gas_spring" not in named
    assert "These tests cannot show: load_cell_gain, coil_lag." in named
    assert "A remark." in named
    assert "The largest error is in " in named
    class_ = told(
        status="class", members=("gas_spring", "fluid_inertia"), separating_test="two frequencies"
    )
    assert (
        "gas_spring may as well be fluid_inertia: these tests do not tell them apart; "
        "this would tell: two frequencies." in class_
    )
    family = told(status="family", id=None)
    assert "gas_spring stands for the family reactive: its cause is not known" in family


def test_what_remains_is_a_known_discrepancy():
    diagnosis = found(make(effect_kind("gas_spring")))
    rest = replace(diagnosis.unknown, present=True, because=("It grows with current.",))
    card = card_of(replace(diagnosis, unknown=rest))
    assert "It grows with current." in card.known_discrepancies


def test_without_effects_the_card_is_the_base_models():
    plain = replace(found(), causes=(), gain=None, base=nothing().base, rivals=nothing().rivals)
    card = card_of(plain)
    assert card.effects == ()
    assert verify(card).effects == ()
    assert card.quality.held_out_mean_nrmse == nothing().base.held_out_nrmse
    blind = replace(plain, base=replace(plain.base, held_out_nrmse=float("nan")))
    assert card_of(blind).quality.held_out_mean_nrmse is None
    assert any("No test was held out" in z for z in card_of(blind).known_discrepancies)


def test_an_open_direction_is_told():
    diagnosis = found(make(effect_kind("gas_spring")))
    covariance = diagnosis.covariance.copy()
    covariance[-1, -1] = diagnosis.values[-1] ** 2
    card = card_of(replace(diagnosis, covariance=covariance))
    assert any("gas_spring.k_g is not determined" in z for z in card.known_discrepancies)
