"""Fast slice of `fleet_batched.py`: dampers off the end of a line, and a hard kind of damper."""

import numpy as np
from best_known import NEAR
from fleet_batched import from_truth
from fleet_dampers import END_OF_LINE, draw_dampers

from sysid.fleet.fit import fit_fleet
from sysid.fleet.stack import stack_loops

WIDER = (14, 54)
"""Dampers of the fleet whose loops are wider than their peak velocity at the largest current: the
force does not pass zero before the rod turns."""


def test_dampers_off_the_line_are_found_at_their_global_optimum():
    dampers = draw_dampers(30, END_OF_LINE)
    dampers += [draw_dampers(1, END_OF_LINE, first=k)[0] for k in WIDER]
    fleet = [damper.loops for damper in dampers]
    found = fit_fleet(fleet, starts=3)
    reached = found.cost <= from_truth(dampers, stack_loops(fleet)) * (1.0 + NEAR)
    assert reached[-2:].all(), "the start must know of loops that are wider than v_m"
    assert reached.sum() >= 31
    assert sum(result.name == "converged" for result in found.results) >= 31
    errors = np.array([np.mean(one) for one in found.nrmse])
    assert np.all((errors > 0.004) & (errors < 0.012)), "1 % of RMS is what noise leaves"
