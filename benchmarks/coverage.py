"""How often the 95 % intervals of a fit contain the truth."""

import numpy as np
from campaigns import draw_campaign
from outcome import Outcome, arguments
from proportions import Share

from sysid.identification.fit import fit_loops
from sysid.uncertainty.covariance import sandwich


def hits(seed: int) -> dict[str, bool]:
    """Symbol of each identified parameter of one campaign → its interval contains the truth."""
    campaign = draw_campaign(seed)
    variant = "symmetric" if campaign.symmetric else "asymmetric"
    estimates = sandwich(fit_loops(campaign.loops, variant=variant))
    return {
        p.symbol: p.low <= campaign.truth[p.symbol] <= p.high
        for p in estimates.parameters
        if p.symbol in estimates.symbols and p.identified
    }


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 100, 10)
    found = [hits(20_000 + seed) for seed in range(campaigns)]
    pooled = [inside for one in found for inside in one.values()]
    share = Share(sum(pooled), len(pooled))
    misses = np.array([sum(not inside for inside in one.values()) for one in found])
    symbols = sorted({symbol for one in found for symbol in one})
    by_symbol = {s: [one[s] for one in found if s in one] for s in symbols}
    outcome = Outcome("coverage", "Coverage of the 95 % intervals")
    outcome.say(
        f"{campaigns} random campaigns (110 loops, 22 conditions, noise 1 %), fitted with the",
        "model that made them (symmetric tables: the symmetric variant).  Intervals: sandwich over",
        "conditions.  Only parameters that the fit calls identified count.",
    )
    outcome.say(f"All parameters together: {share} of the intervals contain the truth (aim 95 %).")
    outcome.say(
        "Parameters of one campaign share their noise, so the shares are not independent:",
        f"{np.mean(misses == 0) * 100:.0f} % of the campaigns miss no parameter,",
        f"{np.mean(misses >= 3) * 100:.0f} % miss three or more.",
    )
    outcome.table(
        ("parameter", "intervals that contain the truth"),
        [(s, Share(sum(inside), len(inside))) for s, inside in by_symbol.items()],
    )
    outcome.numbers = {
        "pooled": share.as_dict(),
        "by_symbol": {s: Share(sum(i), len(i)).as_dict() for s, i in by_symbol.items()},
    }
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
