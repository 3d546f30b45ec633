"""A card from a fit, and the pieces that every card is made of."""

from collections.abc import Iterable, Sequence

import numpy as np

from sysid import __version__
from sysid.cards.check import check_vectors
from sysid.cards.noise import mean_cycle_noise_nrmse, repeatability_nrmse
from sysid.cards.schema import (
    SCHEMA,
    Card,
    Covariance,
    Damper,
    DataFile,
    Drawn,
    Parameter,
    Posterior,
    Quality,
    Validity,
)
from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.identification.problem import record_motion
from sysid.identification.result import Fit, TestError
from sysid.models.damper import Damper as Model
from sysid.motion.motion import Motion
from sysid.uncertainty.estimate import Estimate, Estimates
from sysid.uncertainty.posterior import Posterior as Draws

POOR = 0.10
"""NRMSE of a test above which a card mentions it among its known discrepancies."""


def card_of(
    fit: Fit,
    estimates: Estimates,
    loops: Loops,
    records: Iterable[Record],
    *,
    others: Sequence[Record] = (),
    damper: str,
    campaign: str,
    remarks: Sequence[str] = (),
    posterior: Posterior | None = None,
) -> Card:
    """Put everything that a simulator and its user need into one card.

    Args:
        fit: The fit.
        estimates: Its parameters with their intervals.
        loops: The campaign's loops; those that the fit used make the validity box.
        records: The campaign's records, for the files' hashes.
        others: Tests that are not sinusoidal; likewise.
        damper: Name of the damper.
        campaign: Name of the campaign.
        remarks: Further sentences for the known discrepancies.
        posterior: Summary of draws (`posterior_of`), where there are any.

    Returns:
        A card without any time of making: the same fit gives the same bytes.
    """
    used = {t.id for t in fit.tests if t.used}
    own = [record for record in others if record.id in used]
    validity = validity_box(
        loops.select(np.array([name in used for name in loops.ids], dtype=bool)),
        [record_motion(record) for record in own],
        [float(record.displacement.mean()) for record in own],
    )
    return Card(
        format=SCHEMA,
        software=f"sysid {__version__}",
        model=fit.model,
        variant=fit.variant,
        weights=fit.weights,
        damper=Damper(name=damper, campaign=campaign),
        parameters=tuple(parameter_of(e) for e in estimates.parameters),
        effects=(),
        covariance=covariance_of(estimates.symbols, estimates.covariance),
        posterior=posterior,
        interval=estimates.interval,
        validity=validity,
        quality=quality_of(fit, loops),
        known_discrepancies=(*discrepancies(fit, estimates), *remarks),
        data=files_of(records, used),
        check=check_vectors(Model(fit.valve), validity),
    )


def validity_box(loops: Loops, motions: Sequence[Motion], centres: Sequence[float]) -> Validity:
    """The box of measured conditions of the fitted tests.

    Args:
        loops: Fitted loops.
        motions: Motions of the other fitted tests; of their amplitude only the largest distance
            from the mean counts, and they have no frequency.
        centres: Mean displacement of those tests on the rig, m, compression positive.
    """
    reach = [float(np.abs(m.displacement).max()) for m in motions]
    speeds = [float(np.abs(m.velocity).max()) for m in motions]
    currents = [np.asarray(m.current) for m in motions]
    temperatures = [np.asarray(m.temperature) for m in motions]
    temperature = np.concatenate([loops.temperature, *temperatures])
    known = temperature[np.isfinite(temperature)]
    return Validity(
        amplitude=_span(np.concatenate([loops.amplitude, reach])),
        frequency=_span(loops.frequency) if loops.ids else None,
        velocity=(0.0, float(np.concatenate([loops.peak_velocity, speeds]).max())),
        current=_span(np.concatenate([loops.current, *currents])),
        temperature=_span(known) if known.size else None,
        centre=float(np.median(np.concatenate([loops.centre, centres]))),
    )


def _span(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def quality_of(fit: Fit, loops: Loops) -> Quality:
    """Mean errors, and how well the used tests repeat."""
    used = {t.id for t in fit.tests if t.used}
    fitted = loops.select(np.array([n in used for n in loops.ids], bool))
    return Quality(
        mean_nrmse=fit.mean_nrmse,
        held_out_mean_nrmse=fit.held_out_mean_nrmse,
        noise_floor_nrmse=repeatability_nrmse(fitted),
        mean_cycle_noise_nrmse=mean_cycle_noise_nrmse(fitted),
    )


def discrepancies(fit: Fit, estimates: Estimates) -> tuple[str, ...]:
    """What the user of a card must know about its errors, one sentence each."""
    told = [
        *error_sentences(fit.tests), *estimates.undetermined, *fit.notes,
        *left_sentences(fit.tests),
    ]  # fmt: skip
    if not any(t.held_out for t in fit.tests):
        told.append("No test was held out: the errors are those of tests that were fitted.")
    return tuple(told)


def error_sentences(tests: Iterable[TestError]) -> tuple[str, ...]:
    """The largest errors of the compared tests."""
    told: list[str] = []
    compared = [t for t in tests if t.used or t.held_out]
    worst = sorted(compared, key=lambda t: (-t.nrmse, t.id))
    if worst:
        told.append(f"The largest error is in {_error(worst[0])}.")
    poor = [t for t in worst[1:] if t.nrmse > POOR]
    if poor:
        shown = "; ".join(_error(t) for t in poor[:4])
        more = f"; and {len(poor) - 4} more" if poor[4:] else ""
        told.append(f"Above {POOR:.0%} of max|F| are also: {shown}{more}.")
    return tuple(told)


def left_sentences(tests: Iterable[TestError]) -> tuple[str, ...]:
    """The tests that were neither fitted nor held out."""
    left = [t for t in tests if not t.used and not t.held_out]
    return tuple(f"{t.id} was left out: {t.why_not}." for t in left)


def _error(test: TestError) -> str:
    kind = ", held out" if test.held_out else ""
    return f"{test.id}{kind}: RMSE {test.rmse:.4g} N, {test.nrmse:.2%} of max|F|"


def parameter_of(e: Estimate) -> Parameter:
    """A parameter with its interval; ends and deviations that are not known are null."""
    return Parameter(
        symbol=e.symbol,
        name=e.name,
        value=float(e.value),
        unit=e.unit,
        sd=_finite(e.sd),
        low=_finite(e.low),
        high=_finite(e.high),
        identified=bool(e.identified),
    )


def covariance_of(symbols: tuple[str, ...], covariance: np.ndarray) -> Covariance:
    """The covariance made exactly symmetric.

    Args:
        symbols: [n] as in the card.
        covariance: [n, n].
    """
    c = np.asarray(covariance, dtype=np.float64)
    symmetric = 0.5 * (c + c.T)
    return Covariance(
        symbols=symbols,
        matrix=tuple(tuple(float(z) for z in row) for row in symmetric),
    )


def posterior_of(drawn: Draws, file: str | None) -> Posterior:
    """Summary of draws for a card.

    Args:
        drawn: The draws.
        file: Name of the file that holds them, beside the card.
    """
    evidence = drawn.convergence
    return Posterior(
        file=file,
        likelihood=drawn.likelihood,
        assumed=drawn.assumed,
        prior=drawn.prior,
        interval=drawn.interval_words,
        ensembles=drawn.draws.shape[0],
        draws=drawn.draws.shape[0] * drawn.draws.shape[1],
        converged=evidence.reached,
        message=drawn.account,
        parameters=tuple(
            Drawn(
                symbol=p.symbol,
                median=p.value,
                sd=p.sd,
                low=p.low,
                high=p.high,
                identified=p.identified,
                rhat=_finite(evidence.rhat[k]),
                ess_bulk=_finite(evidence.bulk[k]),
                ess_tail=_finite(evidence.tail[k]),
            )
            for k, p in enumerate(drawn.parameters)
        ),
    )


def files_of(records: Iterable[Record], ids: set[str]) -> tuple[DataFile, ...]:
    """Hashes of the files of some records, by name."""
    files = {r.source.file: r.source.sha256 for r in records if r.id in ids}
    return tuple(DataFile(file=name, sha256=files[name]) for name in sorted(files))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
