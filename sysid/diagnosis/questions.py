"""What a diagnosis leaves open: explanations that its tests do not tell apart."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Sizes
from sysid.models.damper import Damper

Kind = Literal["class", "invisible"]


@dataclass(frozen=True)
class Alternative:
    """One explanation.

    Attributes:
        ids: Of the effects that make it up: those in question.
        damper: Fitted to all tests.
        symbols: [k] of its free parameters, effects as "id.symbol".
        ties: (follower, leader) of parameters of the valve that are kept equal.
        covariance: [k, k] of the free parameters, SI; the empty [0, 0] where they are taken as
            known.
    """

    ids: tuple[str, ...]
    damper: Damper
    symbols: tuple[str, ...]
    ties: tuple[tuple[str, str], ...]
    covariance: Float[np.ndarray, "k k"]


@dataclass(frozen=True)
class Question:
    """Something that the tests leave open.

    Attributes:
        kind: "class": all alternatives are possible.  "invisible": the first one has an effect
            that the second would absorb.
        about: Ids of the effects in question.
        alternatives: At least two.
    """

    kind: Kind
    about: tuple[str, ...]
    alternatives: tuple[Alternative, ...]


@dataclass(frozen=True)
class Told:
    """Something open that no simulated test answers, with the test that would.

    Attributes:
        about: Ids of the effects in question.
        test: In words.
    """

    about: tuple[str, ...]
    test: str


@dataclass(frozen=True)
class Open:
    """What a diagnosis leaves open, and with what errors a further test would be measured.

    Attributes:
        questions: Classes first.
        told: What is open besides.
        sizes: Standard deviations of the parts of Σ.
        noise: N, of each coefficient of a test's cycle mean.
    """

    questions: tuple[Question, ...]
    told: tuple[Told, ...]
    sizes: Sizes
    noise: float
