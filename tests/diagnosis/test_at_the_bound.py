"""A fit that a loose Σ lets go to its bound is held by a smaller one where that suits it better."""

import jax.numpy as jnp
import pytest

from sysid.diagnosis.bases import fit_bases, with_error_models
from sysid.diagnosis.contenders import score_candidates, start_with, with_effect
from sysid.diagnosis.prototypes import prototypes
from sysid.diagnosis.state import settle
from sysid.likelihood import settling
from sysid.models.coordinates import valve_at
from sysid.rig.trial_campaign import make_trial
from sysid.trials.trial_id import parse_id, spec_of


@pytest.fixture(scope="module")
def pocket():
    """A gas pocket behind a reversal, whose formula in the catalogue is nearly right."""
    spec = spec_of(parse_id("one:30002"))
    trial = make_trial(spec.seed, spec.hidden, spec.percents or None, spec.design)
    bases = fit_bases(
        trial.loops, (("generalized", "symmetric"),), history=trial.history, seed=spec.seed,
        progress=lambda _: None,
    )  # fmt: skip
    base = with_error_models(bases)[0]
    state = settle(base.evidence, base.free.coordinates, base.free.u)
    air = [e for e in prototypes(base.evidence.size) if e.facts.id == "entrained_air"]
    scored = score_candidates(base.evidence, state, air)[0]
    extended = with_effect(state.coordinates, scored.effect)
    return base.evidence, state, scored, extended, start_with(state, extended, scored)


def test_what_the_score_promises_is_gained(pocket):
    evidence, before, scored, extended, start = pocket
    after = settle(evidence, extended, start, before.covariance)
    assert after.likelihood - before.likelihood > 0.5 * 0.5 * scored.score
    air = valve_at(extended, jnp.asarray(after.u)).effects[-1]
    assert float(air.delta_a) == pytest.approx(3.22e-5, rel=0.1)


def test_under_the_loose_covariance_alone_it_is_worse_than_nothing(pocket, monkeypatch):
    evidence, before, _, extended, start = pocket
    monkeypatch.setattr(settling, "AT", float("inf"))
    assert settle(evidence, extended, start, before.covariance).likelihood < before.likelihood


def test_where_the_bound_holds_nothing_the_tight_one_is_not_tried(pocket, monkeypatch):
    evidence, before, *_ = pocket
    tried = []
    plain = settling.fit_sizes

    def noted(*args, times=settling.TIMES, **options):
        tried.append(times)
        return plain(*args, times=times, **options)

    monkeypatch.setattr(settling, "fit_sizes", noted)
    settle(evidence, before.coordinates, before.u)
    assert set(tried) == {settling.TIMES}
