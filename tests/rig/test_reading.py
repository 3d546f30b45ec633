"""The shipped virtual datasets read as a campaign, with the manifest and without."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.rig.truth import open_seal

DATASETS = Path(__file__).parents[2] / "datasets"
NAMES = ["virtual-w11-low", "virtual-w11-high", "virtual-w11-asymmetric", "virtual-asymmetric"]


@pytest.mark.parametrize("name", NAMES)
def test_default_reading_gives_the_same_as_the_manifest(name, tmp_path):
    bare = tmp_path / "bare"
    shutil.copytree(DATASETS / name, bare)
    (bare / "campaign.toml").unlink()
    told, plain = load_campaign(DATASETS / name), load_campaign(bare)
    assert told.notes == plain.notes == ()
    assert [r.id for r in told.records] == [r.id for r in plain.records]
    assert [r.nominal.run_order for r in told.records] == list(range(1, len(told.records) + 1))
    for one, other in zip(told.records, plain.records, strict=True):
        assert one.nominal == other.nominal
        assert np.array_equal(one.force, other.force)
        assert np.array_equal(one.displacement, other.displacement)


@pytest.mark.parametrize("name", NAMES)
def test_loops_have_the_true_motion(name):
    """What the data path finds in the raw files is what the bench did."""
    truth = open_seal(DATASETS / name / "sealed" / "truth.json").tests
    cut = cut_loops(load_campaign(DATASETS / name).records)
    assert cut.left_out == {}
    loops = cut.loops
    assert len(loops.ids) == len(truth)
    for k, test in enumerate(loops.ids):
        true = truth[test]
        assert loops.amplitude[k] == pytest.approx(true["amplitude"], rel=2e-4)
        assert loops.frequency[k] == pytest.approx(true["frequency"], rel=5e-5)
        assert loops.centre[k] == pytest.approx(true["centre"], abs=5e-6 + 1e-4 * true["amplitude"])
        assert loops.cycles[k] >= 7
