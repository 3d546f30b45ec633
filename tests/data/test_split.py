"""Held-out tests by glob."""

import pytest

from sysid.data.split import hold_out
from sysid.errors import SysidError

IDS = ("10mm2Hz_0A", "10mm2Hz_1A", "25mm0x5Hz_1A", "runs#3")


def test_globs_match_whole_ids_and_add_up() -> None:
    assert hold_out(IDS, ["*_1A"]).tolist() == [False, True, True, False]
    assert hold_out(IDS, ["10mm*", "runs#3"]).tolist() == [True, True, False, True]
    assert hold_out(IDS, []).tolist() == [False] * 4


@pytest.mark.parametrize("glob", ["*_2A", "10mm2Hz", "*_1a"])
def test_a_glob_that_matches_nothing_is_an_error(glob: str) -> None:
    with pytest.raises(SysidError, match="matches none of the 4 tests"):
        hold_out(IDS, ["*", glob])
