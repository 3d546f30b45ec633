"""One identification from selected tests to the files of its result."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sysid.cards.build import card_of, posterior_of
from sysid.cards.doubts import doubts
from sysid.cards.noise import mean_cycle_noise
from sysid.cards.schema import Card
from sysid.cards.write import card_text, json_text
from sysid.cli.drawing import Drawn, Draws, draw, draw_files, told_of_draws
from sysid.cli.one_current import one_current
from sysid.cli.selection import Selection
from sysid.cli.sweep import Sweep, sweep_of
from sysid.identification.at_odds import AtOdds, at_odds
from sysid.identification.fit import fit_loops
from sysid.identification.problem import Weights, record_motion
from sysid.identification.result import Fit, Result
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.report.fit_json import fit_json
from sysid.report.history_plot import history_png
from sysid.report.intervals_json import intervals_json
from sysid.report.loop_plots import loops_png, worst_png
from sysid.uncertainty.estimate import Estimates
from sysid.uncertainty.side_by_side import SideBySide, side_by_side

if TYPE_CHECKING:
    from sysid.data.campaign import Campaign
    from sysid.report.page.provenance import Origin

HOPELESS = 0.25
"""Mean RMSE/max|F| above which a fit is not to be trusted whatever its residuals look like: a
quarter of the peak force is wrong."""


@dataclass(frozen=True)
class Identified:
    """A result, ready to be written and shown.

    Attributes:
        fit: The fit.
        intervals: Of its parameters, by several rules.
        card: Its card.
        summary: The content of fit.json.
        files: Name → content, of everything that goes into the output folder.
        distrust: Why the result must not be trusted; empty where it may.
        sweep: What else a fit of the lumped model tells.
        drawn: Posterior and profiles, where they were asked for and there are loops.
        advice: What could be asked for instead, and what of it could not be had.
        odd: Tests that all others contradict; None where there are none.
        noise: Test → noise of its mean cycle, N; those that are no loops are not in it.
    """

    fit: Fit
    intervals: SideBySide
    card: Card
    summary: dict[str, Any]
    files: dict[str, bytes]
    distrust: tuple[str, ...]
    sweep: Sweep | None = None
    drawn: Drawn | None = None
    advice: tuple[str, ...] = ()
    odd: AtOdds | None = None
    noise: dict[str, float] = field(default_factory=dict)

    @property
    def estimates(self) -> Estimates:
        """Parameters with the card's intervals."""
        return self.intervals.card


def identify(
    campaign: "Campaign",
    selection: Selection,
    *,
    model: str,
    variant: str,
    weights: Weights,
    seed: int,
    suffix: str = "",
    remarks: Sequence[str] = (),
    draws: Draws | None = None,
    folder: Path | None = None,
    origin: "Origin | None" = None,
    progress: Callable[[str], None] | None = None,
) -> Identified:
    """Fit, judge and describe.

    Args:
        campaign: Where the tests come from.
        selection: Which tests are used.
        model: Name of the model.
        variant: Its variant.
        weights: How tests are weighted.
        seed: Of the scatter of starts.
        suffix: Put behind the names of the files, e.g. ``-1``.
        remarks: Sentences for fit.json and for the card's known discrepancies.
        draws: How to draw from the posterior; not at all if None.
        folder: Where chains grow, so that they can go on after a kill.
        origin: What the page tells of the run; no page is made if None.
        progress: Called with a line now and then.

    Raises:
        FitError: The tests cannot be fitted as asked.
    """
    loops = selection.loops
    fit = fit_loops(
        loops, model=model, variant=variant, weights=weights, others=selection.others,
        held_out=selection.held_out, left_out=selection.left_out, seed=seed, progress=progress,
    )  # fmt: skip
    if progress is not None:
        progress("intervals: errors of rig and laws")
    intervals = side_by_side(fit, loops)
    estimates = intervals.card
    if intervals.because is not None:
        remarks = (*remarks, f"{intervals.because}.")
    advice = (*one_current(fit, selection), *told_of_draws(draws, fit, selection))
    odd = at_odds(fit, loops.select(~selection.held_out[: len(loops.ids)]))
    remarks = (*remarks, *selection.doubts, *selection.remarks, *advice)
    remarks = (*remarks, *(odd.words if odd else ()))
    sweep = sweep_of(fit, loops)
    if sweep is not None:
        remarks = (*remarks, *sweep.remarks)
    drawn = None
    if draws is not None:
        drawn = draw(
            draws, fit, selection, near=intervals.errors, seed=seed, suffix=suffix, folder=folder,
            say=progress,
        )  # fmt: skip
    distrusted = (*selection.untrusted, *distrust(fit))
    card = card_of(
        fit, estimates, loops, campaign.records, others=selection.others,
        damper=campaign.name, campaign=campaign.name, remarks=(*doubts(distrusted), *remarks),
        posterior=posterior_of(drawn.posterior, f"posterior{suffix}.h5") if drawn else None,
    )  # fmt: skip
    summary = fit_json(fit, estimates, loops, remarks) | {
        "intervals": intervals_json(intervals),
        "trusted": not distrusted,
        "distrust": list(distrusted),
    }
    if sweep is not None:
        summary |= sweep.json()
    if drawn is not None:
        summary |= drawn.json()
    files = {
        f"fit{suffix}.json": json_text(summary).encode(),
        f"card{suffix}.json": card_text(card).encode(),
        f"worst{suffix}.png": _worst(fit, selection),
    }
    if sweep is not None:
        picture = sweep.picture(f"{campaign.name}: straight-line recipes")
        if picture is not None:
            files[f"straight_lines{suffix}.png"] = picture
    if drawn is not None:
        files |= draw_files(drawn, fit, suffix)
    if loops.ids:
        files[f"loops{suffix}.png"] = loops_png(loops, campaign.name)
    if origin is not None:
        from sysid.report.page.fit_page import fit_page
        from sysid.report.page.render import render

        page = fit_page(fit, estimates, card, summary, loops, selection.others, origin, distrusted)
        files[f"report{suffix}.html"] = render(page)
    return Identified(
        fit, intervals, card, summary, files, distrusted, sweep, drawn, advice, odd,
        mean_cycle_noise(loops),
    )  # fmt: skip


def distrust(fit: Fit) -> tuple[str, ...]:
    """Why a fit must not be trusted; empty where it may."""
    told = []
    if fit.result is not Result.converged:
        told.append(fit.result.value)
    if not fit.mean_nrmse <= HOPELESS:
        told.append(
            f"the mean error of the fitted tests is {fit.mean_nrmse:.0%} of max|F|: this model "
            "does not describe this damper, or the data are not what they claim to be"
        )
    return tuple(told)


def _worst(fit: Fit, selection: Selection) -> bytes:
    """The test with the largest relative error, held-out ones included."""
    worst = max((t for t in fit.tests if t.used or t.held_out), key=lambda t: t.nrmse)
    kind = "held out" if worst.held_out else "fitted"
    title = f"Worst test: {worst.id} ({kind}), RMSE {worst.nrmse:.2%} of max|F|"
    loops = selection.loops
    if worst.id in loops.ids:
        one = loops.select(np.array([loops.ids.index(worst.id)]))
        return worst_png(one, 0, np.asarray(simulate(fit.valve, loop_motion(one)))[0], title)
    record = next(r for r in selection.others if r.id == worst.id)
    force = np.asarray(simulate(fit.valve, record_motion(record)))
    return history_png(record, force, title)
