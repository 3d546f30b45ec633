"""What `sysid fit --model lumped` tells of a sweep over temperature beside the parameters."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table

from sysid.cli.console import Talk
from sysid.data.heating import whole_test
from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.identification.recipes_beside import RecipesBeside, recipes_beside
from sysid.identification.result import Fit
from sysid.identification.statics import Statics, statics_of
from sysid.identification.temperature_laws import TemperatureLaws, compare_laws
from sysid.models.lumped import Lumped
from sysid.report.straight_lines_plot import straight_lines_png
from sysid.report.sweep_json import laws_json, statics_json, straight_lines_json


@dataclass(frozen=True)
class Sweep:
    """Beside a fit of the lumped model.

    Attributes:
        statics: Static forces that the fit took out.
        recipes: The paper's straight lines; None where they cannot be read.
        why_not: Why they cannot, a sentence.
        laws: Straight lines against bent ones, or a sentence why there is no comparison.
        remarks: Sentences for fit.json and for the card's known discrepancies.
    """

    statics: Statics | None
    recipes: RecipesBeside | None
    why_not: str
    laws: TemperatureLaws | str
    remarks: tuple[str, ...]

    def json(self) -> dict[str, Any]:
        """Keys of fit.json."""
        told: dict[str, Any] = {"straight_lines": None, "temperature_laws": None}
        if self.statics is not None:
            told["static_force"] = statics_json(self.statics)
        if self.recipes is not None:
            told["straight_lines"] = straight_lines_json(self.recipes)
        if not isinstance(self.laws, str):
            told["temperature_laws"] = laws_json(self.laws)
        return told

    def picture(self, title: str) -> bytes | None:
        """Points used and lines, where there are any."""
        if self.recipes is None:
            return None
        return straight_lines_png(self.recipes.loops, self.recipes.found, title)


def sweep_of(fit: Fit, loops: Loops) -> Sweep | None:
    """Look at a fit of the lumped model to loops; None for anything else.

    Args:
        fit: The fit.
        loops: The campaign's loops; only those that were fitted are read.
    """
    used = {t.id for t in fit.tests if t.used}
    own = loops.select(np.array([name in used for name in loops.ids], dtype=bool))
    if not isinstance(fit.valve, Lumped) or not own.ids:
        return None
    statics = statics_of(fit, own)
    recipes, why_not = _recipes(fit.valve, own)
    remarks = () if statics is None else (_statics_words(fit, statics),)
    wholes = {whole_test(name) for name in own.ids}
    if len(wholes) < len(own.ids):
        remarks += (
            f"{len(own.ids)} parts of {len(wholes)} recordings were fitted. What is wrong with a "
            "whole recording (gain, delay, thermometer) is in all of its parts, and so in no "
            "interval: repeat recordings to know it.",
        )
    laws = compare_laws(fit)
    if not isinstance(laws, str):
        remarks += _curved_words(laws)
    return Sweep(statics, recipes, why_not, laws, remarks)


def show_sweep(talk: Talk, sweep: Sweep) -> None:
    """Straight lines with their bias, or why there are none."""
    from sysid.cli.straight_line_tables import show_straight_lines

    talk.notes(sweep.remarks)
    if sweep.recipes is None:
        talk.say(sweep.why_not)
    else:
        recipes = sweep.recipes
        show_straight_lines(talk, recipes.found, recipes.bias, recipes.unbiased)
    if isinstance(sweep.laws, str):
        talk.say(sweep.laws)
    else:
        talk.show(laws_table(sweep.laws))


def laws_table(laws: TemperatureLaws) -> Table:
    """One row a law: how much it bends, and whether that pays on tests left out."""
    table = Table(
        title="Straight lines in temperature against each law bent, all currents alike",
        caption=f"mean RMSE/max|F| over {laws.blocks} pairs of excitation and temperature, each "
        f"predicted without it; straight lines: {laws.error:.3%}; intervals: "
        f"{100 * laws.level:.1f} %, so that a straight law is called bent in 5 % of campaigns at "
        "most",
    )
    table.add_column("law")
    for name in ("of the change, over half-way", "error, bent", "gain", "interval"):
        table.add_column(name, justify="right")
    table.add_column("")
    for law in laws.laws:
        table.add_row(
            law.symbol, f"{law.middle:.0%}", f"{law.error:.3%}", f"{law.gain:+.3%}",
            f"{law.low:+.3%} … {law.high:+.3%}", "bends" if law.curved else "no bend shown",
        )  # fmt: skip
    return table


def _recipes(valve: Lumped, loops: Loops) -> tuple[RecipesBeside | None, str]:
    try:
        beside = recipes_beside(valve, loops)
    except FitError as cause:
        return None, f"The paper's straight lines cannot be read: {cause.what}."
    if beside.any_line:
        return beside, ""
    why = "; ".join(beside.found.undetermined)
    return None, f"The paper's straight lines cannot be read: {why}."


def _curved_words(laws: TemperatureLaws) -> tuple[str, ...]:
    """Which laws bend, for the card: it has straight lines."""
    return tuple(
        f"{law.symbol} bends over temperature: {law.middle:.0%} of its change is over half-way; "
        f"bent like that, the error on tests left out falls from {laws.error:.2%} to "
        f"{law.error:.2%}. The card has straight lines."
        for law in laws.laws
        if law.curved
    )


def _statics_words(fit: Fit, statics: Statics) -> str:
    """What the static forces are, and what they do to the errors."""
    line, size = statics.line, f"{statics.value.mean():.3g} N on average"
    if line is not None:
        _, (_, steep) = line.intervals
        cold, hot = float(line.temperature.min()), float(line.temperature.max())
        at, sd = line.at(np.array([cold]))
        size = (
            f"{at[0]:.3g} ± {line.quantile * sd[0]:.1g} N at {cold:.3g} °C, changing by "
            f"{line.slope:.2g} ± {steep - line.slope:.1g} N per kelvin up to {hot:.3g} °C"
        )
    return (
        "A static force beside the model (gas, zero of the load cell), one a test, was fitted with "
        f"the parameters: {size}. It is no part of the card, so its errors contain it; without it "
        f"the mean RMSE/max|F| of the fitted tests is {statics.mean_nrmse:.2%} instead of "
        f"{fit.mean_nrmse:.2%}."
    )
