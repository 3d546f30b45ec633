"""The page of what physical trials could tell at best is that of the trials that are there."""

import json

from outcome import RESULTS
from physical_bound import NAME, report


def test_the_page_is_that_of_the_rows():
    """Which mechanisms are told at their own level follows from trials that raise nothing."""
    written = json.loads((RESULTS / f"{NAME}.json").read_text("utf-8"))
    found = report(written).numbers
    for key in ("at_level", "can_be"):
        assert found[key] == written[key], "run `python benchmarks/physical_bound.py --page`"
