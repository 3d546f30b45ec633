"""What other effects make of an effect that acts otherwise in one direction."""

import numpy as np
import pytest

from sysid.diagnosis.contenders import score_candidates
from sysid.diagnosis.directions import one_way, share_of_its_own
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.prototypes import prototypes
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import DESIGN
from tests.diagnosis.test_one_sided import fitted


def shares(base_state, planters, percents):
    """Score and share of every candidate beside friction and an offset that were fitted."""
    found = gather(make_trial(71, tuple(map(find_planter, planters)), percents, DESIGN).loops)
    state = fitted(base_state, planters, percents)
    candidates = [e for e in prototypes(found.size) if e.facts.id not in state.ids]
    directions = one_way(found, state)
    scores = score_candidates(found, state, candidates)
    return {
        s.effect.facts.id: (s.score, share_of_its_own(s.signature, directions, state))
        for s in scores
    }


def test_what_looks_like_friction_in_one_direction_is_nothing_of_its_own(base_state):
    found = shares(base_state, ("one_sided_lip",), (4.0,))
    strange = {id: one for id, one in found.items() if one[0] > 40.0}
    assert strange  # the offset alone does not carry what the lip does at reversals
    assert max(share for _, share in strange.values()) < 0.3


@pytest.mark.parametrize(
    ("planter", "cause"), [("rod_play", "backlash"), ("orifice", "quadratic_loss")]
)
def test_a_second_effect_keeps_its_score(base_state, planter, cause):
    score, share = shares(base_state, ("stiff_seal", planter), (1.0, 2.0))[cause]
    assert score > 40.0
    assert share > 0.9


def test_friction_in_one_direction_is_mostly_a_constant_force(base_state):
    found = gather(make_trial(71, (find_planter("stiff_seal"),), (1.0,), DESIGN).loops)
    state = fitted(base_state, ("stiff_seal",), (1.0,))
    friction = one_way(found, state)[:, :, state.ids.index("presliding_friction")]
    of_mean = friction[:, 0] ** 2 / np.sum(friction**2, axis=1)
    assert np.median(of_mean) > 0.8


def test_without_effects_all_of_the_score_is_a_candidate_s_own(base_state):
    nothing = np.zeros((*base_state.gls.residual.shape, 0))
    assert share_of_its_own(base_state.gls.residual, nothing, base_state) == 1.0
