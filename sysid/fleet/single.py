"""One damper of a fleet as the fit that it would have had alone."""

import numpy as np

from sysid.data.loops import Loops
from sysid.fleet.result import FleetFit
from sysid.identification.conditions import conditions
from sysid.identification.fit import loop_errors
from sysid.identification.problem import loop_problem
from sysid.identification.result import Fit
from sysid.models.generalized_coordinates import GeneralizedCoordinates


def fit_of(found: FleetFit, damper: int, loops: Loops) -> Fit:
    """What `fit_loops` returns, for intervals, cards and reports.

    Args:
        found: Of the fleet.
        damper: From 0.
        loops: Its loops.
    """
    problem = loop_problem(loops, found.weights)
    valve = found.valve(damper)
    return Fit(
        model="generalized",
        variant=found.variant,
        weights=found.weights,
        valve=valve,
        coordinates=GeneralizedCoordinates(problem.reference, found.variant),
        u=found.u[damper],
        problems=(problem,),
        condition=conditions(loops),
        cost=float(found.cost[damper]),
        result=found.results[damper],
        starts=int(found.starts[damper]),
        basins=found.basins[damper],
        tests=loop_errors(valve, loops, np.zeros(len(loops.ids), dtype=bool)),
    )
