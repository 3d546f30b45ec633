"""Intervals by several rules, in `fit.json`."""

from typing import Any

from sysid.report.fit_json import known
from sysid.uncertainty.side_by_side import SideBySide


def intervals_json(found: SideBySide) -> list[dict[str, Any]]:
    """One object a rule, the card's first; parameters that the variant holds fixed are left out.

    Args:
        found: The intervals.
    """
    return [
        {
            "interval": estimates.interval,
            "in_card": estimates is found.card,
            "parameters": {
                p.symbol: {
                    "value": known(p.value),
                    "sd": known(p.sd),
                    "low": known(p.low),
                    "high": known(p.high),
                    "identified": p.identified,
                }
                for p in estimates.parameters
                if p.symbol in estimates.symbols
            },
        }
        for estimates in found.all
    ]
