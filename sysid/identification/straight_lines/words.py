"""What the straight lines say, in sentences."""

import numpy as np

from sysid.identification.straight_lines.curvature import SHOWN, pooled_p
from sysid.identification.straight_lines.recipes import StraightLines
from sysid.identification.straight_lines.scatter import ScatterSplit


def sentences(found: StraightLines) -> tuple[str, ...]:
    """Tests taken, what the choice of points moves, curvature, scatter, what is missing."""
    told = []
    for stage, lines in (
        (found.viscosity, found.viscosity_lines),
        (found.yield_force, found.yield_lines),
        (found.stiffness, found.stiffness_lines),
    ):
        if not stage.readings:
            continue
        left = f"; {len(stage.left_out)} tests left out" if stage.left_out else ""
        spread = stage.spread
        moved = f", other windows move it by {spread:.1%}" if np.isfinite(spread) else ""
        told.append(f"{stage.symbol} from {stage.rule}, points at {stage.window}{moved}{left}.")
        p = pooled_p([z.line for z in lines])
        if np.isfinite(p):
            verdict = "all currents together bend" if p < SHOWN else "no curvature shown"
            told.append(f"{stage.symbol} against temperature: {verdict} (p = {p:.2g}).")
    if found.independence is not None:
        one = found.independence
        amps = ", ".join(f"{z:.3g}" for z in one.currents)
        word = "differ" if one.shown else "are not told apart"
        told.append(
            f"Lines of k at {amps} A {word}: by at most {one.difference:.1%} of the pooled one "
            f"(p = {one.p:.2g})."
        )
    if found.scatter is not None:
        told.append(_scatter(found.scatter))
    return (*told, *(f"{z}." for z in found.undetermined))


def _scatter(split: ScatterSplit) -> str:
    low, high = split.temperature_interval
    text = (
        f"k scatters by {split.total:.1%} about its lines: choice of points {split.choice:.1%} "
        f"({split.shared:.1%} if they were chosen anew in every test), repeated cycles "
        f"{split.noise:.1%}, the rest {split.rest:.1%}, as much as an error of temperature of "
        f"{split.temperature:.2g} K ({low:.2g} … {high:.2g}); k moves up to {split.slope:.1%} a "
        "kelvin."
    )
    if split.told is None or split.unexplained is None:
        return text
    return f"{text} Beyond the told {split.told:.2g} K, {split.unexplained:.1%} is unexplained."
