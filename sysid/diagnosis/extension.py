"""A base with the effects found on it, and what they are worth."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sysid.diagnosis.bases import Base
from sysid.diagnosis.coarse import COARSE, select_coarsely
from sysid.diagnosis.constancy import VariedSize
from sysid.diagnosis.contenders import laws_are_right
from sysid.diagnosis.decoys import strangest
from sysid.diagnosis.held_out import gain_of, leave_conditions_out
from sysid.diagnosis.ladder import Shares, Verdict, shares
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.remainder import lawful
from sysid.diagnosis.result import Gain
from sysid.diagnosis.selection import Selection, select
from sysid.diagnosis.state import State, settle


@dataclass(frozen=True)
class Extended:
    """A base with the effects found on it.

    Attributes:
        base: The base.
        selection: What was added and why.
        free: The extended model, fitted for free runs.
        share: How much it explains.
        gain: On tests not seen; None where nothing was added.
        verdicts: Of each effect.
        strange: Log-likelihood that a force which no effect has would gain beside them.
        refuted: Effects whose size differs from test to test as their formula does not say.
        coarse: Effects were sought by least squares and tests not seen, without Σ.
    """

    base: Base
    selection: Selection
    free: State
    share: Shares
    gain: Gain | None
    verdicts: tuple[Verdict, ...]
    strange: float = 0.0
    refuted: tuple[VariedSize, ...] = ()
    coarse: bool = False

    @property
    def error(self) -> float:
        """Mean held-out error of base and effects together."""
        return self.base.error if self.gain is None else self.gain.after

    @property
    def typical(self) -> float:
        """Median over tests of that error.

        At the edge of the matrix, where laws extrapolate, a few tests can be far off although the
        model is right.
        """
        errors = self.base.held_out if self.gain is None else self.gain.per_test_after
        return float(np.median(errors))


def extend(
    base: Base, most: int, seed: int, say: Callable[[str], None], *, coarse: bool
) -> Extended:
    """Select effects on a base and measure what they are worth.

    Args:
        base: The base.
        most: Effects to add at most.
        seed: Of the decoys.
        say: Called with a line now and then.
        coarse: By least squares and tests not seen, since the best base is far off (`far_off`); a
            base whose laws are wrong altogether is extended so in any case.
    """
    evidence = base.evidence
    say(f"{base.fit.model}: looking for effects")
    plain = unweighted(evidence)
    coarse = coarse or base.in_sample > COARSE
    if coarse:
        selection = select_coarsely(plain, base.free, most=most, progress=say)
        free = selection.final
    else:
        state = settle(evidence, base.free.coordinates, base.free.u)
        selection = select(evidence, state, most=most, progress=say)
        free = plainly_fitted(plain, selection.final.coordinates, selection.final.u)
    gain = None
    if selection.kept:
        after = leave_conditions_out(plain, free)
        gain = gain_of(evidence, base.held_out, after)
    law_errors = None if coarse else lawful(evidence, selection.final)
    final = selection.final
    share = shares(
        evidence, base.free, free, final.sizes, law_errors,
        right=lambda: (
            not coarse and bool(selection.kept) and laws_are_right(selection.evidence, final)
        ),
    )  # fmt: skip
    strange = strangest(evidence, selection.final, seed)
    return Extended(base, selection, free, share, gain, (), strange, coarse=coarse)
