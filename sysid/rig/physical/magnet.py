"""The magnetic circuit: from the coil's current, through iron with hysteresis, to yield stress."""

from typing import Final

import equinox as eqx
import numpy as np
from jaxtyping import Float

MU_0: Final = 4e-7 * np.pi
"""Magnetic constant, T·m/A."""
Values = Float[np.ndarray, "..."]
Ways = Float[np.ndarray, "way test"]


class Magnet(eqx.Module):
    """A coil on an iron core, two gaps with fluid in the way of its flux.

    Attributes:
        turns: Of the coil.
        iron: Length of the flux's way in iron, m.
        narrowing: Area of a pole over that of the core: the core's flux density is so many times
            the gap's.
        saturation: Flux density at which the iron is saturated, T.
        permeability: Relative, of iron far from saturation.
        coercive: Field that the iron keeps, A/m.
        loop_width: Change of the gap's flux density over which a reversal is forgotten, T.
        resistance: Of the coil, Ω.
        inductance: H.
        amplifier: Gain of the current loop, V/A; the lag is L/(R + gain).
    """

    turns: float
    iron: float
    narrowing: float
    saturation: float
    permeability: float
    coercive: float
    loop_width: float
    resistance: float
    inductance: float
    amplifier: float

    @property
    def lag(self) -> float:
        """Time constant of the current behind what is asked for, s."""
        return self.inductance / (self.resistance + self.amplifier)

    def iron_field(self, density: Values) -> Values:
        """H in the core, A/m, at a flux density in the gap, T; without hysteresis.

        H = B_c/(μ_0 μ_r) / (1 − (B_c/B_s)⁸): linear, then a wall at saturation.
        """
        core = np.clip(density * self.narrowing / self.saturation, -0.999999, 0.999999)
        return core * self.saturation / (MU_0 * self.permeability * (1.0 - core**8))


def fluid_density(field: Values, solids: float) -> Values:
    """B, T, of magnetorheological fluid at H, A/m.

    B = 1.91 φ^1.133 (1 − exp(−10.97 μ_0 H)) + μ_0 H, odd in H.

    Source:
        Carlson, MR fluids and devices in the real world, Int. J. Mod. Phys. B 19 (2005) 1463–1470;
        for the shape, Jolly, Bender, Carlson, Properties and applications of commercial
        magnetorheological fluids, J. Intell. Mater. Syst. Struct. 10 (1999) 5–13.
    """
    vacuum = MU_0 * np.abs(field)
    full = 1.91 * solids**1.133 * -np.expm1(-10.97 * vacuum) + vacuum
    return np.sign(field) * full


def field_yield_stress(field: Values, solids: float) -> Values:
    """τ_y, Pa, at 40 °C: 271 700 φ^1.5239 tanh(6.33·10⁻⁶ H), Carlson 2005, in hydrocarbon oil."""
    return 271_700.0 * solids**1.5239 * np.tanh(6.33e-6 * np.abs(field))


def fluid_field(magnet: Magnet, gap: float, solids: float, current: Values, kept: Values) -> Values:
    """H in the gaps, A/m, by bisection of N i = 2 h H + l H_iron(B(H)) + l H_c q.

    Args:
        magnet: The circuit.
        gap: h, m.
        solids: Share of iron in the fluid.
        current: A.
        kept: q, between −1 and 1: which way the iron's domains lag.
    """
    drive = np.asarray(magnet.turns * current - magnet.iron * magnet.coercive * kept)
    low = np.full_like(drive, -1e7)
    high = np.full_like(drive, 1e7)
    for _ in range(55):
        middle = 0.5 * (low + high)
        density = fluid_density(middle, solids)
        over = 2.0 * gap * middle + magnet.iron * magnet.iron_field(density) > drive
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return 0.5 * (low + high)


def after_history(
    magnet: Magnet, gap: float, solids: float, currents: Ways, steps: int = 40
) -> Float[np.ndarray, " test"]:
    """H in the gaps, A/m, after a virgin circuit was taken through currents one after the other.

    On a way with rising or falling flux the iron's lag tends to ±1, each reversal being forgotten
    over a change ΔB of the flux density: q ← ±1 + (q ∓ 1) exp(−|ΔB|/B_h).

    Args:
        magnet: The circuit.
        gap: h, m.
        solids: Share of iron in the fluid.
        currents: A, in turn, from 0.
        steps: Parts of each way.

    Source:
        Coleman, Hodgdon, A constitutive relation for rate-independent hysteresis in
        ferromagnetically soft materials, Int. J. Eng. Sci. 24 (1986) 897–919, with constant
        coefficients.
    """
    start = np.zeros(currents.shape[1])
    kept, field, density = np.zeros_like(start), np.zeros_like(start), np.zeros_like(start)
    for target in currents:
        for k in range(1, steps + 1):
            current = start + (target - start) * k / steps
            field = fluid_field(magnet, gap, solids, current, kept)
            new = fluid_density(field, solids)
            way = np.sign(target - start)
            forgotten = np.exp(-np.abs(new - density) / magnet.loop_width)
            kept, density = way + (kept - way) * forgotten, new
        start = target
    return fluid_field(magnet, gap, solids, start, kept)
