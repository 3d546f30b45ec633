"""What the actuator does: rest, a ramp of the amplitude, steady cycles, a ramp down, rest."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.rig.elementary import cosine, sine

Samples = Float[np.ndarray, " n"]
TWO_PI: Final = 6.283185307179586


@dataclass(frozen=True)
class State:
    """True motion of the piston at given times.

    Attributes:
        displacement: [n] m, in the coordinate of the displacement sensor, centre included.
        velocity: [n] m/s.
        acceleration_sign: [n] minus the sign of the displacement's fundamental: sgn ẍ of W11
            Eq. 7 without the actuator's harmonics.
        peak_velocity: [n] v_m, m/s: envelope of the fundamental times ω.  In the steady cycles
            this is Aω, in a ramp it follows the amplitude, at rest it is 0; W11 Eq. 10 gives the
            same on a pure steady sinusoid.
    """

    displacement: Samples
    velocity: Samples
    acceleration_sign: Samples
    peak_velocity: Samples


@dataclass(frozen=True)
class Harmonic:
    """A harmonic that a servo-hydraulic actuator adds to its sinusoid.

    Attributes:
        order: 2 or more.
        size: Relative to the fundamental.
        lead: Phase at the start of a cycle of the fundamental, in turns.
    """

    order: int
    size: float
    lead: float


@dataclass(frozen=True)
class SineRun:
    """One sinusoidal test from switching on to switching off.

    x = c + A E(t) [sin φ + Σ s_n sin(n φ + λ_n)], φ = 2πf (t − rest), where the envelope E rises
    as a raised cosine over the first cycles, stays 1 and falls over the last.

    Attributes:
        amplitude: Of the fundamental, m.
        frequency: Hz.
        centre: m.
        harmonics: What the actuator adds.
        rest: Before and after the motion, s.
        ramp_up: Cycles.
        steady: Cycles at full amplitude.
        ramp_down: Cycles.
    """

    amplitude: float
    frequency: float
    centre: float
    harmonics: tuple[Harmonic, ...]
    rest: float
    ramp_up: float
    steady: float
    ramp_down: float

    @property
    def duration(self) -> float:
        """Of the whole test, s."""
        return 2.0 * self.rest + (self.ramp_up + self.steady + self.ramp_down) / self.frequency

    def steady_part(self, time: Samples) -> np.ndarray:
        """[n] whether each time, s, lies in the steady cycles."""
        turns = (time - self.rest) * self.frequency
        return (turns >= self.ramp_up) & (turns <= self.ramp_up + self.steady)

    def state(self, time: Samples) -> State:
        """The true motion, velocity by differentiating the formula.

        Args:
            time: [n] s.
        """
        turns = (time - self.rest) * self.frequency
        envelope, slope = self._envelope(turns)
        shape, turning = sine(turns), cosine(turns)
        fundamental = shape * envelope
        for harmonic in self.harmonics:
            angle = harmonic.order * turns + harmonic.lead
            shape = shape + harmonic.size * sine(angle)
            turning = turning + harmonic.order * harmonic.size * cosine(angle)
        omega = TWO_PI * self.frequency
        return State(
            displacement=self.centre + self.amplitude * envelope * shape,
            velocity=self.amplitude * (omega * envelope * turning + self.frequency * slope * shape),
            acceleration_sign=-np.sign(fundamental),
            peak_velocity=self.amplitude * omega * envelope,
        )

    def _envelope(self, turns: Samples) -> tuple[Samples, Samples]:
        """E and dE/d(turns): raised cosines at both ends."""
        end = self.ramp_up + self.steady + self.ramp_down
        up = np.clip(turns / self.ramp_up, 0.0, 1.0)
        down = np.clip((end - turns) / self.ramp_down, 0.0, 1.0)
        rise, fall = 0.5 * (1.0 - cosine(0.5 * up)), 0.5 * (1.0 - cosine(0.5 * down))
        rising = 0.25 * TWO_PI * sine(0.5 * up) / self.ramp_up
        falling = -0.25 * TWO_PI * sine(0.5 * down) / self.ramp_down
        return rise * fall, rising * fall + rise * falling
