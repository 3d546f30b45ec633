"""`sysid validate`: a card's error on a campaign, in free run."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.options import (
    CampaignArgument,
    CardArgument,
    FlipForce,
    Json,
    ManifestOption,
    Quiet,
    UnusedSeed,
)
from sysid.errors import FitError

if TYPE_CHECKING:
    from sysid.cards.schema import Card
    from sysid.cli.selection import Selection
    from sysid.identification.result import TestError
    from sysid.models.damper import Damper
    from sysid.motion.history import RunHistory

WORSE = 2.0
"""A card fails where its mean error inside its validity is so many times what it states, …"""
AT_LEAST = 0.05
"""… and above 5 % of max|F|; up to there that is a note."""


@dataclass(frozen=True)
class Verdict:
    """Errors of a card on a campaign.

    Attributes:
        tests: Errors of the tests that could be compared.
        outside: Id → respects in which the test leaves the card's validity.
        distrust: Why the comparison says that the card must not be trusted here.
        stated: What the card states, RMSE / max|F|: its error on held-out tests, where it has any
            and that is larger, else on fitted ones.
        inside: Mean of the tests inside the card's validity; None where there are none.
        notes: What the user should know of that.
    """

    tests: "tuple[TestError, ...]"
    outside: dict[str, tuple[str, ...]]
    distrust: tuple[str, ...]
    stated: float
    inside: float | None
    notes: tuple[str, ...] = ()

    @property
    def ratio(self) -> float | None:
        """Mean error inside the card's validity over what it states; None where one is not."""
        return self.inside / self.stated if self.inside is not None and self.stated > 0.0 else None


def validate(
    card: CardArgument,
    campaign: CampaignArgument,
    manifest: ManifestOption = None,
    flip_force: FlipForce = False,
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Measure how well a card predicts a campaign: free-run error of every test.

    Exit code 3 where tests lie outside the card's validity, or the mean error inside it is above
    5 % of max|F| and more than twice what the card states (of its fitted and held-out errors the
    larger). More than twice that, but at most 5 %, is a note.
    """
    talk = Talk(json, quiet)

    from sysid.cards.noise import mean_cycle_noise
    from sysid.cards.read import read_card
    from sysid.cards.verify import verify
    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.doubted import told_of_doubts
    from sysid.cli.selection import select
    from sysid.cli.tables import error_table
    from sysid.data.campaign import load_campaign

    parsed = read_card(card, check=False)
    doubted = told_of_doubts(talk, parsed, card)
    keep_compiled(talk)
    damper = verify(parsed, where=str(card))
    with talk.progress(f"Reading {campaign}"):
        loaded = load_campaign(campaign, manifest, flip_force=flip_force)
        chosen = select(loaded, (), ())
    selection = with_current(chosen)
    loops, left_out = selection.loops, selection.left_out
    talk.notes(loaded.notes)
    talk.left_out(left_out)
    talk.warnings(selection.doubts)
    if not loops.ids and not selection.others:
        raise FitError(
            "has no test that can be compared", where=campaign, advice="Run `sysid check` on it"
        )

    from sysid.identification.fit import loop_errors, record_errors
    from sysid.motion.history import history_of

    history = history_of(loops.ids, loaded.records, loops)
    errors = (
        *loop_errors(damper, loops, history=history),
        *record_errors(damper, selection.others),
    )
    verdict = judge(parsed, leaving(parsed, damper, selection), errors)
    notes = (*told_of_effects(damper, selection, history), *verdict.notes)
    talk.notes(notes)
    noise = mean_cycle_noise(loops)
    talk.show(error_table(verdict.tests, noise))
    mean = sum(t.nrmse for t in verdict.tests) / len(verdict.tests)
    ratio = verdict.ratio
    times = "" if ratio is None else f", inside its validity it is {ratio:.1f} times that"
    talk.say(
        f"Mean RMSE/max|F| {mean:.2%} over {len(verdict.tests)} tests; "
        f"the card states {verdict.stated:.2%}{times}"
    )
    told = _object(parsed, loaded.name, verdict, mean, left_out, noise)
    talk.result({**told, "notes": [*doubted, *notes]})
    if verdict.distrust:
        talk.distrust(verdict.distrust)
        raise typer.Exit(3)


def told_of_effects(
    damper: "Damper", selection: "Selection", history: "RunHistory | None"
) -> tuple[str, ...]:
    """Effects of the card that these tests cannot put to work.

    Args:
        damper: Of the card.
        selection: The tests.
        history: Of its loops; None where their order is not known.
    """
    from sysid.cards.idle import idle_effects
    from sysid.identification.problem import record_motion
    from sysid.motion.history import with_history
    from sysid.motion.motion import loop_motion

    if not (damper.effects or damper.valve.thermal):
        return ()
    motions = [record_motion(r) for r in selection.others]
    if selection.loops.ids:
        motions.insert(0, with_history(loop_motion(selection.loops), history))
    return tuple(dict.fromkeys(s for m in motions for s in idle_effects(damper, m)))


def with_current(selection: "Selection") -> "Selection":
    """Leave out the tests whose current nobody tells."""
    import numpy as np

    loops, others = selection.loops, selection.others
    known = np.isfinite(loops.current)
    told = [r.current is not None or r.nominal.current is not None for r in others]
    silent = [name for name, is_known in zip(loops.ids, known, strict=True) if not is_known]
    silent += [r.id for r, is_known in zip(others, told, strict=True) if not is_known]
    return replace(
        selection,
        loops=loops.select(known),
        others=tuple(r for r, is_known in zip(others, told, strict=True) if is_known),
        left_out={**selection.left_out, **dict.fromkeys(silent, "its current is not known")},
    )


def leaving(card: "Card", damper: "Damper", selection: "Selection") -> dict[str, tuple[str, ...]]:
    """Id of each test → respects in which it leaves the card's validity."""
    import math

    from sysid.cards.idle import assumed_temperature
    from sysid.cards.motion_box import motion_outside
    from sysid.cards.outside import outside
    from sysid.identification.problem import record_motion

    loops, assumed = selection.loops, assumed_temperature(damper)
    left: dict[str, tuple[str, ...]] = {}
    for k, name in enumerate(loops.ids):
        i, t = float(loops.current[k]), float(loops.temperature[k])
        warm = t if math.isfinite(t) else assumed
        left[name] = outside(
            card.validity,
            amplitude=float(loops.amplitude[k]),
            frequency=float(loops.frequency[k]),
            velocity=float(loops.peak_velocity[k]),
            current=(i, i),
            temperature=None if warm is None else (warm, warm),
        )
    others = {
        r.id: motion_outside(card.validity, record_motion(r), assumed) for r in selection.others
    }
    return {**left, **others}


def judge(
    card: "Card", left: dict[str, tuple[str, ...]], errors: "tuple[TestError, ...]"
) -> Verdict:
    """Hold conditions against the card's validity, and errors against what it states."""
    distrust = [
        f"{name} is outside the card's validity: {'; '.join(told)}"
        for name, told in left.items()
        if told
    ]
    held = [t.nrmse for t in errors if not left[t.id]]
    inside = sum(held) / len(held) if held else None
    stated = max(card.quality.mean_nrmse, card.quality.held_out_mean_nrmse or 0.0)
    notes = []
    if inside is not None and not inside <= WORSE * stated:
        found = (
            f"inside its validity the card's mean error is {inside:.1%} of max|F|, it states "
            f"{stated:.1%}: "
        )
        if inside <= AT_LEAST:
            notes.append(f"{found}this may be another damper, or one that has changed")
        else:
            distrust.append(f"{found}this is another damper, or it has changed")
    return Verdict(errors, left, tuple(distrust), stated, inside, tuple(notes))


def _object(
    card: "Card",
    campaign: str,
    verdict: Verdict,
    mean: float,
    left_out: dict[str, str],
    noise: dict[str, float],
) -> dict[str, Any]:
    from sysid.identification.result import TestError
    from sysid.report.fit_json import known, test_json

    nan = float("nan")
    absent = [TestError(n, nan, nan, nan, nan, False, False, why) for n, why in left_out.items()]
    entries = [
        {
            **test_json(t, noise),
            "used": t.why_not is None,
            "outside": list(verdict.outside.get(t.id, ())),
        }
        for t in sorted((*verdict.tests, *absent), key=lambda t: t.id)
    ]
    return {
        "schema": "sysid-validation-1",
        "model": card.model,
        "campaign": campaign,
        "tests": entries,
        "summary": {
            "mean_nrmse": known(mean),
            "card_mean_nrmse": card.quality.mean_nrmse,
            "inside_mean_nrmse": known(verdict.inside),
            "stated_nrmse": verdict.stated,
            "ratio": known(verdict.ratio),
        },
        "trusted": not verdict.distrust,
        "distrust": list(verdict.distrust),
    }
