"""What was done to a damper before a test, for effects that remember it."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.data.supply import same_current
from sysid.motion.motion import Motion

PerTest = Float[np.ndarray, " test"]


@dataclass(frozen=True)
class RunHistory:
    """Place of tests in their campaign, and how the current came to each of them.

    It is made of all tests of a campaign; a part of these keeps the places it had among all.

    Attributes:
        share: [L] 0 for the first test of the campaign, 1 for its last one.
        ramp: [L] sign of the last change of current before the test, 0 before the first change.
    """

    share: PerTest
    ramp: PerTest

    def select(self, tests: np.ndarray) -> "RunHistory":
        """Some of the tests.

        Args:
            tests: [L] True for those that are kept, or their places.
        """
        return RunHistory(self.share[tests], self.ramp[tests])


def run_history(order: np.ndarray, current: PerTest) -> RunHistory:
    """History of all tests of a campaign.

    Measured currents scatter: those that the supply cannot have been set apart by are no change.

    Args:
        order: [L] position of each test in the campaign, any increasing numbers.
        current: [L] A; NaN where it is not known, which changes nothing.
    """
    places = np.asarray(order, dtype=float)
    first, last = places.min(), places.max()
    share = (places - first) / max(last - first, 1.0)
    return RunHistory(share, _ramp(places, current))


def history_of(ids: Sequence[str], records: Sequence[Record], loops: Loops) -> RunHistory | None:
    """History of some tests of a campaign; None unless the place of each of them is known.

    Args:
        ids: Of the tests.
        records: All tests of the campaign, those that are held out or left out as well.
        loops: Those of them that are steady, with the current that they were run at.
    """
    run_at = dict(zip(loops.ids, loops.current.tolist(), strict=True))
    told = [r for r in records if r.nominal.run_order is not None]
    at = {record.id: k for k, record in enumerate(told)}
    if not ids or any(name not in at for name in ids):
        return None
    order = np.array([r.nominal.run_order for r in told], dtype=float)
    whole = run_history(order, np.array([run_at.get(r.id, _commanded(r)) for r in told]))
    return whole.select(np.array([at[name] for name in ids]))


def with_history(
    motion: Motion,
    history: RunHistory | None = None,
    *,
    cycle: Float[np.ndarray, " loop"] | None = None,
) -> Motion:
    """The same loops with their place in the campaign.

    Args:
        motion: L loops.
        history: Of these L tests, if known.
        cycle: [L] number of the cycle in its test, from 0.

    Returns:
        With `run_share`, `ramp` and `cycle` as far as they follow.
    """
    changes = {}
    if history is not None:
        changes["run_share"] = jnp.asarray(history.share[:, None])
        changes["ramp"] = jnp.asarray(history.ramp[:, None])
    if cycle is not None:
        changes["cycle"] = jnp.asarray(cycle[:, None])
    return dataclasses.replace(motion, **changes)


def into_cycle(loops: Loops, points: int) -> Float[np.ndarray, "loop point"]:
    """Time of each phase point since the middle of its cycle, in cycles; [L, 1] zeros if unknown.

    Added to the number of a cycle it is what `Motion.cycle` is at every point.

    Args:
        loops: L tests.
        points: Of the phase grid.
    """
    if loops.start_phase is None:
        return np.zeros((len(loops.ids), 1))
    turns = np.arange(points)[None, :] / points - loops.start_phase[:, None] / (2.0 * np.pi)
    return np.mod(np.round(turns, 9), 1.0) - 0.5


def _commanded(record: Record) -> float:
    """Current of a test that gives no loop, A: its label, else most of what was recorded, or NaN.

    A record has rest and ramps in it, where the supply may be off: its mean says nothing.
    """
    if record.nominal.current is not None:
        return float(record.nominal.current)
    if record.current is not None and np.isfinite(record.current).any():
        return float(np.nanmedian(record.current))
    return float("nan")


def _ramp(order: PerTest, current: PerTest) -> PerTest:
    """Sign of the last change of current before each test, 0 before the first change."""
    same = same_current(float(np.max(np.abs(current), initial=0.0, where=np.isfinite(current))))
    ramp, last, at = np.zeros(order.size), 0.0, None
    for here in np.argsort(order, kind="stable"):
        if np.isfinite(current[here]):
            change = 0.0 if at is None else current[here] - at
            if at is None or abs(change) > same:
                last, at = float(np.sign(change)), current[here]
        ramp[here] = last
    return ramp
