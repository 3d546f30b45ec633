"""The page of a comparison of cards."""

from collections.abc import Mapping, Sequence

import numpy as np

from sysid.cards.schema import Card
from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.motion.motion import Motion
from sysid.report.page.comparison import CardErrors, Comparison, mean
from sysid.report.page.headline import Bar, Headline, floor_of, known_bars
from sysid.report.page.look import looks
from sysid.report.page.one_test import (
    Force,
    OneTest,
    absent_tests,
    history_test,
    loop_tests,
)
from sysid.report.page.page import Page, make_page
from sysid.report.page.parameter_table import parameter_table
from sysid.report.page.provenance import Origin, provenance
from sysid.report.page.symmetry import what_is_left


def comparison_page(
    cards: Sequence[CardErrors],
    own: Sequence[Card],
    found: Comparison,
    loops: Loops,
    forces: Sequence[Force],
    others: Sequence[tuple[Record, Motion, Sequence[np.ndarray]]],
    origin: Origin,
    left_out: Mapping[str, str],
    distrust: tuple[str, ...] = (),
) -> Page:
    """Gather the page of a comparison.

    Args:
        cards: Errors of each card, loops first, then other tests.
        own: The cards.
        found: Their comparison.
        loops: L sinusoidal tests.
        forces: [L, J] N of each card.
        others: Other tests: record, motion, [n] N of each card.
        origin: Where the tests come from, and what was typed.
        left_out: Test → reason.
        distrust: Why the comparison must not be trusted.
    """
    best = next(k for k, c in enumerate(cards) if c.name == found.best)
    order = [*(k for k in range(len(cards)) if k != best), best]  # the page reads off the last
    cards, own = [cards[k] for k in order], [own[k] for k in order]
    forces = [forces[k] for k in order] if forces else ()
    others = [(record, motion, [f[k] for k in order]) for record, motion, f in others]
    names = [c.name for c in cards]
    by_test = np.stack([c.nrmse for c in cards], axis=1).tolist()
    ids = (*loops.ids, *(record.id for record, _, _ in others))
    errors: dict[str, list[float]] = dict(zip(ids, by_test, strict=True))
    tests: list[OneTest] = list(
        loop_tests(loops, tuple(forces), errors, dict.fromkeys(loops.ids, "compared"))
    )
    tests += [
        history_test(record, motion, own_forces, errors[record.id], "compared")
        for record, motion, own_forces in others
    ]
    bars = [
        Bar(c.name, mean(c.nrmse), "after" if c.name == found.best else "before", look)
        for c, look in zip(cards, looks(len(cards)), strict=True)
    ]
    bars.append(Bar("noise of the mean cycle", floor_of(tests), "floor"))
    tests += absent_tests(left_out, origin.records)
    models = {c.name: c.model for c in cards}
    headline = Headline(
        found.sentence, distrust, (), known_bars(bars),
        "Mean over the tests, in free run.",
    )  # fmt: skip
    return make_page(
        title=origin.campaign, what="Comparison", models=names, headline=headline, tests=tests,
        left=what_is_left(loops, dict(zip(names, forces, strict=True))) if loops.ids else (),
        parameters=tuple(parameter_table(c, n) for c, n in zip(own, names, strict=True)),
        comparison=found, provenance=provenance(origin, models, None),
        tolerance=origin.tolerance,
    )  # fmt: skip
