"""Where in its tests a model is wrong, with what sign, and how the error grows: numbers to words.

Phase is that of the displacement, x = A sin φ: reversals at 90° and 270°, fastest at 0° and 180°.
"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.diagnosis.exponents import Exponent, exponents
from sysid.diagnosis.lack_of_fit import NOISE_HARMONICS
from sysid.diagnosis.words import listed

Region = Literal[
    "after each reversal", "after the reversal at full compression",
    "after the reversal at full extension", "before each reversal", "at the ends of the stroke",
    "at mid stroke", "over the whole stroke",
]  # fmt: skip

SECTOR: Final = 60.0
"""Degrees of a sector: a cycle is two reversals with one before and one after each, and two
sectors about mid stroke, six in all."""
CONCENTRATED: Final = 0.55
"""Share of the energy in a third of the cycle above which the error is said to be there."""
ENDS: Final = 0.8
"""Share of the energy in the two thirds about the reversals above which it is at the ends."""
ONE_SIDED: Final = 0.8
"""Share of what follows both reversals above which one of them alone is named."""
SIGNED: Final = 0.5
"""Signed over unsigned energy above which the error has a sign that can be told."""
STEADY: Final = 0.25
"""Exponents nearer to 0, 1 or 2 than this are called so."""
SAME: Final = 0.1
"""Exponents nearer to 0 than this, surely nearer than twice this, are called no dependence."""
SIDED: Final = (
    "too strong on the compression side and too weak on the extension side,",
    "too weak on the compression side and too strong on the extension side,",
)
"""What errors are called that resist motion on one side of the stroke and help it on the other."""
WARMING: Final = 0.7
"""Correlation of a test's relative error with its temperature above which that is said."""


@dataclass(frozen=True)
class Where:
    """An error of a model, located.

    Attributes:
        test: Index of the test where its RMS is largest.
        peak: N, largest size in that test.
        sense: "too stiff", "too soft", "too strong", "too weak", "too high", "too low", or
            one of `SIDED`; "wrong" where the sign changes within the region.
        region: Part of the cycle.
        travel: m, from the reversal to where the error has fallen to half; None elsewhere.
        growth: How its RMS, N, grows from test to test with one quantity while the others stay,
            e.g. "is the same at every frequency", "grows with current".  As the worst test is the
            worst in newtons, so tests count by newtons here: what small errors do decides nothing.
            It may still be the slowest where the error grows with frequency, if its amplitude is
            larger.
        relative: How the error over the force goes, e.g. "changes with temperature".
    """

    test: int
    peak: float
    sense: str
    region: Region
    travel: float | None
    growth: tuple[str, ...]
    relative: tuple[str, ...]


def where_wrong(
    loops: Loops,
    simulated: Float[np.ndarray, "loop phase"],
    truth: Float[np.ndarray, "loop phase"],
) -> Where:
    """Locate an error.

    Args:
        loops: L tests.
        simulated: [L, J] N.
        truth: [L, J] N, what it should be: another simulation, or measured forces (`smooth`).
    """
    error = simulated - truth
    size = np.sqrt(np.mean(error**2, axis=1))
    k = int(np.argmax(size))
    region = _region(error[k])
    return Where(
        test=k,
        peak=float(np.abs(error[k]).max()),
        sense=_sense(simulated[k], truth[k], region),
        region=region,
        travel=_travel(loops.displacement[k], error[k], region) if "after" in region else None,
        growth=growth_words(exponents(loops, size, weight=size)),
        relative=_warming(loops, error, truth),
    )


def smooth(signals: Float[np.ndarray, "loop phase"]) -> Float[np.ndarray, "loop phase"]:
    """Harmonics 0 … 15 only: what can be seen above the noise of a cycle mean."""
    spectrum = np.fft.rfft(signals, axis=1)
    spectrum[:, NOISE_HARMONICS + 1 :] = 0.0
    return np.fft.irfft(spectrum, n=signals.shape[1], axis=1)


def growth_words(found: tuple[Exponent, ...]) -> tuple[str, ...]:
    """How an error's size depends on amplitude, frequency and current; what is open is left out.

    Returns:
        Verbs with what they apply to, e.g. "is the same at every frequency", "grows with current".
    """
    verbs: dict[str, list[str]] = {}
    for e in sorted(found, key=lambda e: e.quantity != "frequency"):
        verb = _growth(e)
        if verb is not None:
            verbs.setdefault(verb, []).append(e.quantity)
    return tuple(f"{verb} {listed(quantities)}" for verb, quantities in verbs.items())


def _warming(
    loops: Loops, error: Float[np.ndarray, "loop phase"], truth: Float[np.ndarray, "loop phase"]
) -> tuple[str, ...]:
    """Whether the error, relative to the force and with its sign, goes with temperature."""
    known = np.isfinite(loops.temperature)
    energy = np.sum(truth**2, axis=1)
    known &= energy > 0.0
    if known.sum() < 4 or np.ptp(loops.temperature[known]) < 1.0:
        return ()
    share = np.sum(error * truth, axis=1)[known] / energy[known]
    if np.ptp(share) == 0.0:
        return ()
    related = float(np.corrcoef(share, loops.temperature[known])[0, 1])
    return () if abs(related) < WARMING else ("changes with temperature",)


def _growth(e: Exponent) -> str | None:
    """The verb of one quantity's growth, e.g. "grows with"; None where it is open."""
    if not np.isfinite([e.value, e.low, e.high]).all():
        return None
    if abs(e.value) <= SAME and max(-e.low, e.high) <= 2.0 * SAME:
        return "is the same at every"
    if abs(e.value) <= STEADY and max(-e.low, e.high) <= 2.0 * STEADY:
        return "hardly depends on"
    if e.low <= 0.0 <= e.high:
        return None
    narrow = e.high - e.low <= 4.0 * STEADY
    if narrow and abs(e.value - 1.0) <= STEADY:
        return "grows in proportion to"
    if narrow and abs(e.value - 2.0) <= STEADY:
        return "grows with the square of"
    return "grows with" if e.value > 0.0 else "falls with"


def _sectors(points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """[J] each: after full compression, after full extension, before either, mid stroke; phase."""
    phase = 360.0 * np.arange(points) / points
    first = (phase >= 90.0) & (phase < 90.0 + SECTOR)
    second = (phase >= 270.0) & (phase < 270.0 + SECTOR)
    before = ((phase >= 90.0 - SECTOR) & (phase < 90.0)) | (
        (phase >= 270.0 - SECTOR) & (phase < 270.0)
    )
    return first, second, before, ~(first | second | before), phase


def _region(error: Float[np.ndarray, " phase"]) -> Region:
    first, second, before, middle, _ = _sectors(error.size)
    total = float(np.sum(error**2)) or 1.0
    in_first, in_second, in_before, in_middle = (
        float(np.sum(error[part] ** 2)) / total for part in (first, second, before, middle)
    )
    after = in_first + in_second
    if after > CONCENTRATED:
        if in_first > ONE_SIDED * after:
            return "after the reversal at full compression"
        if in_second > ONE_SIDED * after:
            return "after the reversal at full extension"
        return "after each reversal"
    if in_before > CONCENTRATED:
        return "before each reversal"
    if in_middle > CONCENTRATED:
        return "at mid stroke"
    return "at the ends of the stroke" if after + in_before > ENDS else "over the whole stroke"


def _sense(
    simulated: Float[np.ndarray, " phase"], truth: Float[np.ndarray, " phase"], region: Region
) -> str:
    """The sign of an error in words.

    About one reversal it is that of the force's magnitude: on one side of a reversal, speed and
    displacement have one sign each and tell nothing apart.  Elsewhere whichever fits best: against
    motion (strong, weak), against displacement (stiff, soft), or one way (high, low).
    """
    error = simulated - truth
    first, second, before, middle, phase = _sectors(error.size)
    part = {
        "after each reversal": first | second,
        "after the reversal at full compression": first,
        "after the reversal at full extension": second,
        "before each reversal": before,
        "at mid stroke": middle,
        "at the ends of the stroke": ~middle,
    }.get(region, np.ones(error.size, dtype=bool))
    weighted = (error * np.abs(error))[part]
    energy = float(np.sum(error[part] ** 2)) or 1.0
    angle = np.radians(phase[part])
    motion = float(np.sum(weighted * np.sign(np.cos(angle)))) / energy
    displaced = float(np.sum(weighted * np.sign(np.sin(angle)))) / energy
    level = float(np.sum(weighted)) / energy
    if "reversal" in region:
        larger = np.where(np.abs(simulated) > np.abs(truth), simulated, truth)[part]
        magnitude = float(np.sum(weighted * np.sign(larger))) / energy
        return _pair(magnitude, "too stiff", "too soft")
    sided = float(np.sum(weighted * np.sign(np.cos(angle) * np.sin(angle)))) / energy
    found = (
        (motion, "too strong", "too weak"),
        (displaced, "too stiff", "too soft"),
        (level, "too high", "too low"),
        (sided, *SIDED),
    )
    return _pair(*max(found, key=lambda row: abs(row[0])))


def _pair(share: float, more: str, less: str) -> str:
    return "wrong" if abs(share) < SIGNED else more if share > 0.0 else less


def _travel(
    x: Float[np.ndarray, " phase"], error: Float[np.ndarray, " phase"], region: Region
) -> float | None:
    """Mean travel from the reversals that the region names to half the error's peak there."""
    first, second, _, _, _ = _sectors(error.size)
    ends = []
    if "extension" not in region:
        ends.append((int(np.argmax(x)), first))
    if "compression" not in region:
        ends.append((int(np.argmin(x)), second))
    travels = []
    for reversal, part in ends:
        inside = np.flatnonzero(part)
        size = np.abs(error[inside])
        top = int(np.argmax(size))
        below = np.flatnonzero(size[top:] < 0.5 * size[top])
        if below.size == 0:
            return None
        travels.append(abs(float(x[reversal] - x[inside[top + below[0]]])))
    return float(np.mean(travels))
