"""Drawn dampers in an isolator, with and without the directions that the tests leave open."""

from pathlib import Path
from typing import Final

import numpy as np
from outcome import Outcome, arguments

from sysid.cards.read import read_card
from sysid.errors import CardError
from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.compare import LEVEL
from sysid.isolator.drawn_dampers import drawn_dampers
from sysid.isolator.families import Name, family
from sysid.isolator.from_card import damper_of_card
from sysid.isolator.plant import mass_isolator
from sysid.isolator.study import conflict_diagram, stacked
from sysid.uncertainty.covariance import OPEN

FITS: Final = Path(__file__).parents[1] / "fits"
CARDS: Final = ("virtual-w11-low", "virtual-w11-high", "virtual-w11-asymmetric")
SHOWN: Final[tuple[tuple[Name, float], ...]] = (("P", 2000.0), ("OO", 0.2))
SMALL: Final = 0.5e-3
"""m RMS of the base: the pistons stay within the speeds of the cards' tests."""
MOTIONS: Final = 3
EVERYTHING: Final = 1e12
"""No direction is open."""


def main() -> None:
    draws, quick = arguments(__doc__ or "", 40, 4)
    outcome = Outcome("isolator_draws", "Drawn dampers in an isolator")
    base = butterworth_motion(range(1, MOTIONS + 1), duration=2.0, level=SMALL)
    rows, numbers = [], []
    for name in CARDS[: 1 if quick else None]:
        for words, open_from in (("held", OPEN), ("drawn", EVERYTHING)):
            try:
                found = spread(FITS / name / "card.json", base, draws, open_from)
            except CardError:
                rows.append((name, "", words, "most draws are no dampers", "", ""))
                continue
            for controller, ratios in found.items():
                low, high = np.quantile(ratios, [0.5 - LEVEL / 2, 0.5 + LEVEL / 2]) - 1.0
                mean = float(np.mean(ratios)) - 1.0
                cells = (f"{100 * z:+.2f} %" for z in (mean, low, high))
                rows.append((name, controller, words, *cells))
                numbers.append({
                    "card": name, "controller": controller, "open_directions": words,
                    "mean": mean, "low": float(low), "high": float(high),
                })  # fmt: skip
    outcome.say(
        f"RMS acceleration over that of the card's own damper, {draws} draws, mass isolator,",
        f"{1e3 * SMALL:g} mm RMS, {MOTIONS} motions of 2 s.  A direction is open where its",
        f"standard deviation is above {OPEN:g} of the parameters' own sizes.",
    )
    head = ("card", "controller", "open directions", "mean", "2.5 %", "97.5 %")
    outcome.table(head, rows)
    outcome.numbers["draws"] = numbers
    outcome.finish(keep=not quick)


def spread(path: Path, base: BaseMotion, draws: int, open_from: float) -> dict[str, np.ndarray]:
    """Controller → RMS acceleration of each draw over that of the card's own damper."""
    card = read_card(path)
    own = damper_of_card(card)
    drawn = drawn_dampers(card, draws, 1, open_from=open_from)
    steps = stacked([d.step(40.0) for d in (own, *drawn.dampers)])
    table = own.table_from(40.0)
    families = [family(name, table, set_points=(at,)) for name, at in SHOWN]
    names = [str(k) for k in range(draws + 1)]
    found = conflict_diagram(mass_isolator(), families, steps, names, base)
    return {
        c.name: np.mean(c.acceleration[0, 1:] / c.acceleration[0, :1], axis=1) for c in found.curves
    }


if __name__ == "__main__":
    main()
