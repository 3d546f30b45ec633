"""Dampers that a card's uncertainty allows: their spread, what is kept equal, and refusals."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sysid.cards.build import posterior_of
from sysid.cards.schema import Covariance
from sysid.cards.write import json_text
from sysid.errors import CardError
from sysid.isolator.card_study import Order, study_card
from sysid.isolator.drawn_dampers import drawn_dampers
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.models.lumped import Lumped
from sysid.parameters import as_dict, specs
from sysid.report.conflict_plot import conflict_png
from sysid.report.isolator_json import isolator_json
from sysid.uncertainty.compression import CompressionError
from sysid.uncertainty.convergence import Convergence
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.posterior_file import posterior_bytes, thinned
from tests.cards.export.dampers import effect, valve
from tests.isolator.conftest import card_of, lumped_card


def with_covariance(card, deviations):
    """The card with independent parameters, symbol → standard deviation."""
    symbols = tuple(deviations)
    matrix = np.diag([deviations[s] ** 2 for s in symbols])
    covariance = Covariance(symbols=symbols, matrix=tuple(map(tuple, matrix.tolist())))
    return card.model_copy(update={"covariance": covariance})


def test_they_have_the_cards_spread():
    drawn = drawn_dampers(lumped_card(), 200, seed=3)
    assert "covariance" in drawn.source
    slopes = []
    for damper in drawn.dampers:
        assert isinstance(damper.valve, Lumped)
        slopes.append(float(damper.valve.k_slope))
    assert np.std(slopes) == pytest.approx(0.02 * 1.5e5, rel=0.2)
    assert np.mean(slopes) == pytest.approx(1.5e5, rel=0.01)
    again = drawn_dampers(lumped_card(), 200, seed=3).dampers[7]
    assert as_dict(again.valve) == as_dict(drawn.dampers[7].valve)


def test_effects_are_drawn_as_well():
    card = with_covariance(card_of("tanh", effect("seal_friction")), {"seal_friction.F_c": 2.0})
    sizes = [float(d.effects[0].F_c) for d in drawn_dampers(card, 100, seed=1).dampers]  # pyright: ignore[reportAttributeAccessIssue]
    assert np.std(sizes) == pytest.approx(2.0, rel=0.3)


def test_what_a_symmetric_model_keeps_equal_stays_equal():
    """k_1e follows k_1c: as sure as it, equal to it, and without a place in the covariance."""
    card = card_of("generalized")
    known = {p.symbol: p for p in card.parameters}
    sd, value = 0.1 * abs(known["k_1c"].value), known["k_1c"].value
    symmetric = tuple(
        p.model_copy(update={"sd": sd, "value": value}) if p.symbol in ("k_1c", "k_1e") else p
        for p in card.parameters
    )
    card = with_covariance(card.model_copy(update={"parameters": symmetric}), {"k_1c": sd})
    found = [as_dict(d.valve) for d in drawn_dampers(card, 30, seed=1).dampers]
    assert np.std([z["k_1c"] for z in found]) > 0.0
    assert all(z["k_1c"] == z["k_1e"] for z in found)
    assert len({z["k_0"] for z in found}) == 1


def test_open_directions_are_held_and_told():
    """A parameter that the tests leave open would lead to dampers that do not fit."""
    (rho,) = (p.value for p in card_of("bouc_wen").parameters if p.symbol == "rho")
    card = with_covariance(card_of("bouc_wen"), {"rho": 3.0 * rho, "c_a": 1.0})
    drawn = drawn_dampers(card, 20, seed=1)
    found = [as_dict(d.valve) for d in drawn.dampers]
    assert {z["rho"] for z in found} == {rho}
    assert np.std([z["c_a"] for z in found]) > 0.3
    assert "1 directions that the tests leave open are held" in drawn.source


def drawn_of(symbols=("c_a", "q"), seed=0, **changed):
    """A posterior of Kwok's model."""
    declared = tuple(s for s in specs(valve("tanh")) if s.symbol in symbols)
    middle = [800.0 if s.symbol == "c_a" else 1.3 for s in declared]
    n = len(declared)
    draws = middle * (1.0 + 0.01 * np.random.default_rng(seed).standard_normal((2, 400, n)))
    made = Posterior(
        model="tanh", variant="symmetric", likelihood="full", assumed="nothing", prior=("flat",),
        declared=declared, coordinates=draws, draws=draws, log_probability=draws[:, :, 0],
        walkers=4, compression=CompressionError(0.0, 0.0, 1000.0), acceptance=0.3, evaluations=1,
        message="time was spent",
        convergence=Convergence(
            100, np.full(n, 8.0), 1.001 + 1e-3 * draws[0, 0], np.full(n, 900.0),
            np.full(n, np.nan), tuple(s.symbol for s in declared),
        ),
    )  # fmt: skip
    return replace(made, **changed)


def card_beside(made, folder):
    """A card that tells of a posterior, without its file."""
    card = with_covariance(card_of("tanh"), {"c_a": 1.0})
    return card.model_copy(update={"posterior": posterior_of(made, "posterior.h5")}), str(
        folder / "card.json"
    )


def test_draws_of_the_posterior_beside_the_card_come_first(tmp_path):
    made = drawn_of()
    card, where = card_beside(made, tmp_path)
    assert "covariance" in drawn_dampers(card, 4, seed=1, where=where).source  # no file yet
    (tmp_path / "posterior.h5").write_bytes(posterior_bytes(thinned(made)))
    assert not np.array_equal(np.median(thinned(made).flat, 0), np.median(made.flat, 0))
    drawn = drawn_dampers(card, 20, seed=1, where=where)
    found = {as_dict(d.valve)["c_a"] for d in drawn.dampers}
    assert len(found) > 10
    assert found <= set(made.flat[:, 0])
    assert drawn.source.startswith("the posterior's draws, posterior.h5")
    assert "time was spent" in drawn.source


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"model": "carreau"}, "of carreau, symmetric; the card is of tanh"),
        ({"variant": "passive"}, "of tanh, passive"),
        ({"symbols": ("c_a",)}, "of c_a; the card's are c_a, q"),
        ({"seed": 1}, "of c_a: R̂ and the effective number of draws are others"),
        ({"draws": drawn_of().draws * [1.1, 1.0]}, "c_a has the median 8"),
    ],
    ids=["model", "variant", "symbols", "draws", "values"],
)
def test_draws_of_another_fit_are_refused(other, said, tmp_path):
    card, where = card_beside(drawn_of(), tmp_path)
    (tmp_path / "posterior.h5").write_bytes(posterior_bytes(drawn_of(**other)))
    with pytest.raises(CardError, match="draws of another fit") as caught:
        drawn_dampers(card, 4, seed=1, where=where)
    assert said in str(caught.value)
    assert "take this one away" in str(caught.value)


def test_nothing_can_be_drawn_from_nothing():
    card = with_covariance(lumped_card(), {})
    with pytest.raises(CardError, match="no covariance"):
        drawn_dampers(card, 2, seed=1)
    wide = with_covariance(card_of("bouc_wen"), {"rho": 1e9, "c_a": 1e9})
    with pytest.raises(CardError, match="every direction open"):
        drawn_dampers(wide, 50, seed=1)


def w11_card():
    """The printed low set, whose force rises with current."""
    card = card_of("generalized", effect("seal_friction"))
    printed = tuple(
        p.model_copy(update={"value": LOW_SYMMETRIC[p.symbol]}) for p in card.parameters
    )
    return card.model_copy(update={"parameters": printed})


QUICK = {"controllers": ("P",), "motions": 2, "duration": 0.3, "tune": True}


@pytest.mark.parametrize("model", ["generalized", "bouc_wen"])
def test_other_models_are_tuned_and_drawn_too(model):
    card = w11_card() if model == "generalized" else card_of(model, effect("seal_friction"))
    symbol = "F_0" if model == "generalized" else "alpha_b"
    (value,) = (p.value for p in card.parameters if p.symbol == symbol)
    card = with_covariance(card, {symbol: 0.05 * value})
    study = study_card(card, Order(draws=3, **QUICK))
    (drawn,) = study.drawn
    assert drawn.acceleration.shape == (9, 1, 3)
    assert drawn.changes == ()
    assert 1e-4 < np.std(drawn.acceleration) < 0.1
    assert study.ultimate is not None
    assert study.gains.pid[0] == pytest.approx(0.6 * study.ultimate.gain)
    assert 1e-3 < study.ultimate.period < 0.1


def test_runs_that_ran_away_are_told_as_such():
    """W11's exponential on a road that is far too fast for it: no number stands for that."""
    card = with_covariance(w11_card(), {"F_0": 1.0})
    order = Order("quarter-car", ("P",), motions=1, duration=0.5, draws=1)
    study = study_card(card, order)
    assert not study.trusted
    assert np.isnan(study.diagram.curve("P").acceleration).any()
    told = json.loads(json_text(isolator_json(study)))
    assert None in [z for row in told["controllers"][0]["rms_acceleration_m/s2"] for z in row]
    assert conflict_png(study).startswith(b"\x89PNG")


def test_without_a_covariance_none_are_drawn_and_that_is_told():
    card = with_covariance(card_of("tanh"), {})
    study = study_card(card, Order("quarter-car", ("P",), motions=1, duration=0.2))
    assert study.drawn == ()
    assert any("no covariance" in told for told in study.left_out)
    with pytest.raises(CardError, match="--draws 0"):
        study_card(card, Order("quarter-car", ("P",), motions=1, duration=0.2, draws=5))
