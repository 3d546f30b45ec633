"""The posterior of a fit: drawn, written and shown."""

import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from rich.table import Table

if TYPE_CHECKING:
    from sysid.cli.console import Talk
    from sysid.cli.selection import Selection
    from sysid.data.loops import Loops
    from sysid.identification.result import Fit
    from sysid.uncertainty.error_model import ErrorModel, Likelihood
    from sysid.uncertainty.identifiability import Identifiability
    from sysid.uncertainty.loop_bands import LoopBands
    from sysid.uncertainty.posterior import Posterior

PARTS: Final = "posterior{}.parts"
"""Folder that a chain grows in, beside the results; it goes when they are written."""


@dataclass(frozen=True)
class Draws:
    """How to draw.

    Attributes:
        likelihood: Its kind.
        budget: s.
    """

    likelihood: "Likelihood"
    budget: float


@dataclass(frozen=True)
class Drawn:
    """What was drawn, and what the data determine under the same likelihood.

    Attributes:
        posterior: The draws.
        determined: Profiles, directions and quantities.
        bands: Of the force in each test, those held out included.
    """

    posterior: "Posterior"
    determined: "Identifiability"
    bands: "LoopBands"

    def json(self) -> dict[str, Any]:
        """For fit.json."""
        from sysid.report.bands_json import bands_json
        from sysid.report.identifiability_json import identifiability_json

        return {
            "bands": bands_json(self.bands),
            "identifiability": identifiability_json(self.determined, self.posterior.likelihood),
        }


def draw(
    draws: Draws,
    fit: "Fit",
    selection: "Selection",
    *,
    near: "ErrorModel | None",
    seed: int,
    suffix: str,
    folder: Path | None,
    say: Callable[[str], None] | None,
) -> Drawn | None:
    """Draw from the posterior of what was fitted, and profile it; None where `undrawn` says why.

    Args:
        draws: How.
        fit: The fit.
        selection: Its tests; those that are not sinusoidal have no likelihood yet.
        near: Σ at the most probable parameters, where it is known.
        seed: Everything random follows from it.
        suffix: Of the files.
        folder: Of the results.
        say: Called with a line now and then.
    """
    from sysid.uncertainty.identifiability import identifiability
    from sysid.uncertainty.loop_bands import loop_bands
    from sysid.uncertainty.profiles import profiles
    from sysid.uncertainty.sample import errors_of, sample_posterior

    if undrawn(draws, fit, selection) is not None:
        return None
    loops = _fitted(fit, selection)
    errors = errors_of(fit, loops, draws.likelihood, near)
    determined = identifiability(fit, errors, profiles(fit, errors, progress=say))
    posterior = sample_posterior(
        fit, loops, likelihood=draws.likelihood, errors=errors, profiles=determined.profiles,
        seed=seed, budget=draws.budget,
        folder=None if folder is None else folder / PARTS.format(suffix), progress=say,
    )  # fmt: skip
    if say is not None:
        say("posterior: bands of all loops")
    held = selection.held_out[: len(selection.loops.ids)]
    bands = loop_bands(fit, selection.loops, held, posterior, errors, seed)
    return Drawn(posterior, determined, bands)


def undrawn(draws: Draws, fit: "Fit", selection: "Selection") -> str | None:
    """Why there is no posterior of a fit, a sentence; None where there is one.

    Args:
        draws: How to draw.
        fit: The fit.
        selection: Its tests.
    """
    from sysid.uncertainty.side_by_side import MOST

    count = len(_fitted(fit, selection).ids)
    if not count:
        return "No posterior is drawn: its likelihood is one of steady sines, and none was fitted."
    if draws.likelihood == "full" and count > MOST:
        return (
            f"No posterior is drawn: the covariance of errors of rig and laws is sought of at most "
            f"{MOST} tests, and {count} were fitted. --likelihood random_effects draws without "
            "errors of laws; --frequency-range and --amplitude-range fit fewer tests."
        )
    return None


def of_loops_only(fit: "Fit", selection: "Selection") -> str | None:
    """That a posterior knows less than the fit, a sentence; None where it knows all tests.

    Args:
        fit: The fit.
        selection: Its tests.
    """
    count, used = len(_fitted(fit, selection).ids), sum(t.used for t in fit.tests)
    if count == used:
        return None
    return (
        f"The posterior is that of the {count} steady sines alone: the other {used - count} of "
        f"{used} fitted tests have no likelihood yet."
    )


def told_of_draws(draws: Draws | None, fit: "Fit", selection: "Selection") -> tuple[str, ...]:
    """What is to be said of a posterior that was asked for: why there is none, or of what it is.

    Args:
        draws: How to draw; None if none was asked for.
        fit: The fit.
        selection: Its tests.
    """
    if draws is None:
        return ()
    said = undrawn(draws, fit, selection) or of_loops_only(fit, selection)
    return () if said is None else (said,)


def _fitted(fit: "Fit", selection: "Selection") -> "Loops":
    """The loops that were fitted."""
    used = {t.id for t in fit.tests if t.used}
    return selection.loops.select(np.array([n in used for n in selection.loops.ids], dtype=bool))


def draw_files(drawn: Drawn, fit: "Fit", suffix: str) -> dict[str, bytes]:
    """Draws and pictures, name → content."""
    from sysid.parameters import as_dict
    from sysid.report.bands_plot import bands_png
    from sysid.report.corner_plot import corner_png
    from sysid.report.profile_plot import profile_png
    from sysid.report.trace_plot import trace_png
    from sysid.uncertainty.posterior_file import posterior_bytes, thinned

    posterior = drawn.posterior
    return {
        f"posterior{suffix}.h5": posterior_bytes(thinned(posterior)),
        f"corner{suffix}.png": corner_png(posterior, as_dict(fit.valve)),
        f"trace{suffix}.png": trace_png(posterior),
        f"profiles{suffix}.png": profile_png(drawn.determined.profiles),
        f"bands{suffix}.png": bands_png(drawn.bands, "95 % bands of the force"),
    }


def forget_parts(output: Path, files: Iterable[str]) -> None:
    """Remove the folders that chains grew in, now that their results are written."""
    for name in files:
        path = output / name
        if path.name.startswith("posterior") and path.suffix == ".h5":
            shutil.rmtree(path.with_suffix(".parts"), ignore_errors=True)


def show_posterior(talk: "Talk", title: str, drawn: Drawn) -> None:
    """Parameters with their intervals, what is open, and whether the draws can be trusted."""
    from sysid.report.bands_json import band_sentences

    posterior = drawn.posterior
    talk.show(_table(title, posterior))
    talk.say(f"Likelihood: {posterior.assumed}.")
    for line in posterior.prior:
        talk.say(f"Prior: {line}.")
    for line in (*drawn.determined.ends, *band_sentences(drawn.bands)):
        talk.say(f"{line}.")
    if not posterior.convergence.reached:
        missing = "; ".join(posterior.convergence.missing)
        talk.warn(
            f"The posterior has not converged ({posterior.message.removeprefix('not converged: ')})"
            f": {missing}. Give it more time with --posterior-budget."
        )
    if not posterior.compression.small:
        words = posterior.compression.words
        talk.warn(f"{words[0].upper()}{words[1:]}.")


def _table(title: str, posterior: "Posterior") -> Table:
    chains, draws, _ = posterior.draws.shape
    evaluations = f"{posterior.evaluations:,}".replace(",", " ")
    table = Table(
        title=f"{title}: posterior",
        caption=f"{posterior.interval_words}, in the card's `posterior`; "
        f"{chains * draws} draws of {chains} ensembles, {evaluations} evaluations; "
        f"{posterior.message}",
    )
    table.add_column("")
    for name in ("median", "sd", "interval"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    for name in ("R̂", "ESS", "tails"):
        table.add_column(name, justify="right")
    table.add_column("")
    c = posterior.convergence
    for k, p in enumerate(posterior.parameters):
        table.add_row(
            p.symbol, f"{p.value:.5g}", f"{p.sd:.2g}", f"{p.low:.5g} … {p.high:.5g}", p.unit,
            f"{c.rhat[k]:.3f}", f"{c.bulk[k]:.0f}", f"{c.tail[k]:.0f}",
            "" if p.identified else "not determined by these data",
        )  # fmt: skip
    return table
