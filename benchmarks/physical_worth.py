"""What each mechanism of the physical damper is worth: the same campaign without it."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from sysid.rig.physical.campaign import TestsRun

POINTS: Final = 400
"""Steps a cycle; errors of the steps are alike with and without a mechanism."""

LEAST: Final = {"floating_friction": 0.2}
"""Level instead of 0, where bristles without any friction leave nothing that could be solved."""


def worths(dataset: str, kept: Path, *, compute: bool) -> list[dict[str, Any]]:
    """Every mechanism at level 0 and everything else kept, the one that matters most first.

    Args:
        dataset: Of a physical campaign.
        kept: Where results are kept, so that a stopped run goes on.
        compute: Make it if it is not there.

    Returns:
        `name`, `about` and `causes` of the mechanism; `of_force`: RMS change of the force on the
        load cell over the steady cycles of all tests, of the RMS force; `most`: the same of the
        test `where` it is largest.
    """
    from sysid.rig.physical.campaign import run_campaign
    from sysid.rig.physical.mechanisms import MECHANISMS
    from sysid.rig.scenarios.physical import PHYSICAL

    found = json.loads(kept.read_text()) if kept.is_file() else []
    if not compute or len(found) == len(MECHANISMS):
        return sorted(found, key=lambda m: -m["of_force"])
    campaign = replace(next(c for c in PHYSICAL if c.dataset == dataset), points=POINTS)
    own = run_campaign(campaign, campaign.seed)
    done = {m["name"] for m in found}
    for mechanism in MECHANISMS:
        if mechanism.name in done:
            continue
        without = replace(campaign, levels={mechanism.name: LEAST.get(mechanism.name, 0.0)})
        change, force = _squares(own, run_campaign(without, campaign.seed))
        each = np.sqrt(change / force)
        found.append(
            {
                "name": mechanism.name,
                "about": mechanism.about,
                "causes": mechanism.causes,
                "of_force": float(np.sqrt(change.mean() / force.mean())),
                "most": float(each.max()),
                "where": campaign.settings[int(each.argmax())].name,
            }
        )
        print(f"without {mechanism.name}: {found[-1]['of_force']:.2%}", flush=True)
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(found, indent=1))
    return sorted(found, key=lambda m: -m["of_force"])


def _squares(own: "TestsRun", other: "TestsRun") -> tuple[np.ndarray, np.ndarray]:
    """[test] mean squares of the change of force, and of the force, N², over steady cycles."""
    change, force = [], []
    for k, run in enumerate(own.prepared.runs):
        time = own.courses.time[:, k] + run.rest
        steady = run.steady_part(time)
        weight = np.gradient(time[steady])
        mine, theirs = (c.courses.force[steady, k] for c in (own, other))
        change.append(np.average((theirs - mine) ** 2, weights=weight))
        force.append(np.average(mine**2, weights=weight))
    return np.array(change), np.array(force)
