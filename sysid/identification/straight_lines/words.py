"""What the straight lines say, in sentences."""

import numpy as np

from sysid.identification.straight_lines.curvature import SHOWN, pooled_p
from sysid.identification.straight_lines.levels import amperes
from sysid.identification.straight_lines.recipes import StraightLines
from sysid.identification.straight_lines.scatter import ScatterSplit


def sentences(found: StraightLines, unbiased: StraightLines | None = None) -> tuple[str, ...]:
    """Tests taken, what the choice of points moves, curvature, scatter, what is missing.

    Args:
        found: What the recipes gave.
        unbiased: The lines without the recipes' bias, which is curved itself, where it is known.
    """
    told = []
    judged = found if unbiased is None else unbiased
    without = "" if unbiased is None else ", the recipe's bias divided out"
    for stage, lines in (
        (found.viscosity, judged.viscosity_lines),
        (found.yield_force, judged.yield_lines),
        (found.stiffness, judged.stiffness_lines),
    ):
        if not stage.readings:
            continue
        left = f"; {len(stage.left_out)} tests left out" if stage.left_out else ""
        spread = stage.spread
        moved = f", other windows move it by {spread:.1%}" if np.isfinite(spread) else ""
        told.append(f"{stage.symbol} from {stage.rule}, points at {stage.window}{moved}{left}.")
        p = pooled_p([z.line for z in lines])
        if np.isfinite(p):
            verdict = "the lines together bend" if p < SHOWN else "no curvature shown"
            told.append(f"{stage.symbol} against temperature{without}: {verdict} (p = {p:.2g}).")
    if found.independence is not None:
        one = found.independence
        amps = ", ".join(amperes(z) for z in one.currents)
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
        f"k scatters by {split.total:.1%} about its lines. Other windows move single tests by "
        f"{split.choice:.1%} ({split.shared:.1%} if they were chosen anew in every test); repeated "
        f"cycles account for {split.noise:.1%}."
    )
    if split.told is None:
        return (
            f"{text} Most probable: {split.proportional:.1%} from the choice of points and an "
            f"error of temperature of {split.temperature:.2g} K ({low:.2g} … {high:.2g}), where k "
            f"moves up to {split.slope:.1%} a kelvin."
        )
    agrees = "agree with" if low <= split.told <= high else "contradict"
    return (
        f"{text} With the told {split.told:.2g} K, at up to {split.slope:.1%} a kelvin, "
        f"{split.proportional:.1%} is left; the tests {agrees} it ({low:.2g} … {high:.2g} K)."
    )
