"""Straight lines in temperature against bent ones: false alarms, and what a real bend gains."""

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from lumped_recovery import sweep
from outcome import Outcome, arguments

from sysid.data.loops import Loops
from sysid.identification.conditions import conditions
from sysid.identification.fit import fit_loops
from sysid.identification.temperature_laws import TemperatureLaws, compare_laws
from sysid.models.lumped import TABLE_1, Lumped, element_force
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.trials.proportions import Share

CURRENTS: Final = (0.0, 0.2, 0.4, 1.0)
"""A; C_post falls to 0.2 A and rises from there."""
TEMPERATURES: Final = (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
POINTS: Final = 72
NOISE: Final = 0.01
"""Of each test's RMS force, white."""
GAIN: Final = 0.006
"""Of the load cell from test to test, standard deviation."""
THERMOMETER: Final = 0.3
"""K from test to test, standard deviation."""
COLD: Final = 15.0
KELVIN: Final = 273.15


class Viscosity(NamedTuple):
    """C_post = C_post(15 °C) exp(B/(T − T_0) − B/(288 K − T_0)) at every current.

    Attributes:
        name: For people.
        steep: B, K.
        stop: T_0, K.
    """

    name: str
    steep: float
    stop: float

    def factor(self, temperature: np.ndarray) -> np.ndarray:
        """Relative to 15 °C, at °C."""
        t = temperature + KELVIN - self.stop
        return np.exp(self.steep / t - self.steep / (COLD + KELVIN - self.stop))


RIVALS: Final = (
    Viscosity("Arrhenius, C_post −33 % as Table 1", 677.0, 0.0),
    Viscosity("Vogel, C_post −33 % as Table 1", 70.0, 200.0),
    Viscosity("Arrhenius, −63 %", 1650.0, 0.0),
)


def campaign(law: Viscosity | None, seed: int) -> Loops:
    """Table 1 with straight lines, or with another viscosity; errors of a rig on top."""
    loops = sweep(0.0, 0, POINTS, CURRENTS, TEMPERATURES)
    rng = np.random.default_rng([20_090_001, seed])
    table, tests = build(Lumped, TABLE_1), len(loops.ids)
    felt = loops.temperature + THERMOMETER * rng.standard_normal(tests)
    motion = loop_motion(replace(loops, temperature=felt))
    element = table.element(motion)
    if law is not None:
        cold = table.element(loop_motion(replace(loops, temperature=np.full(tests, COLD))))
        element = element._replace(post=cold.post * law.factor(felt)[:, None])
    force = np.array(element_force(element, motion))
    noise = NOISE * np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force *= 1.0 + GAIN * rng.standard_normal((tests, 1))
    return replace(loops, force=force + noise * rng.standard_normal(force.shape))


def compared(loops: Loops) -> TemperatureLaws:
    """Fit with straight lines, one wave of starts, and compare."""
    told = compare_laws(fit_loops(loops, model="lumped", max_waves=1))
    assert not isinstance(told, str)
    return told


def refitted(loops: Loops) -> float:
    """Straight lines' error on blocks left out, each by a fit that goes the whole way."""
    errors = []
    for excitation in (0, 1):
        for temperature in TEMPERATURES:
            out = (conditions(loops) == excitation) & (loops.temperature == temperature)
            fit = fit_loops(loops, model="lumped", max_waves=1, held_out=out)
            errors.append(np.mean([t.nrmse for t in fit.tests if t.held_out]))
    return float(np.mean(errors))


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", 60, 4)
    outcome = Outcome("temperature_laws", "Straight lines in temperature against bent ones")
    outcome.say(
        f"{len(CURRENTS) * len(TEMPERATURES) * 2} loops: {len(CURRENTS)} currents,",
        f"{len(TEMPERATURES)} temperatures from 15 to 75 °C, 10 mm 8 Hz, 5 mm 4 Hz, Table 1 with",
        f"{100 * NOISE:g} % noise, {100 * GAIN:g} % gain and {THERMOMETER:g} K of thermometer from",
        "test to test. Each law is bent in turn, by one number for all currents, and judged on",
        "pairs of excitation and temperature, each predicted without it.",
    )
    rows = []
    for law in (None, *RIVALS):
        count = campaigns if law is None else max(campaigns // 6, 2)
        told = [compared(campaign(law, seed)) for seed in range(count)]
        bends = Share(sum(t.laws[0].curved for t in told), count)
        any_other = Share(sum(any(z.curved for z in t.laws[1:]) for t in told), count)
        any_one = Share(sum(any(z.curved for z in t.laws) for t in told), count)
        middle = np.mean([t.laws[0].middle for t in told])
        errors = np.mean([(t.error, t.laws[0].error) for t in told], axis=0)
        name = "straight lines" if law is None else law.name
        rows.append((
            name, bends, any_one if law is None else any_other, f"{middle:.0%}",
            f"{errors[0]:.2%} → {errors[1]:.2%}",
        ))  # fmt: skip
        outcome.numbers[name] = {
            "C_post": bends.as_dict(), "any": any_one.as_dict(),
            "others": any_other.as_dict(), "middle": float(middle), "errors": errors.tolist(),
        }  # fmt: skip
    outcome.table(
        (
            "made with",
            "C_post called bent",
            "any law (first row), F_y or k (others)",
            "C_post's change over half-way",
            "error left out, lines → C_post bent",
        ),
        rows,
    )
    outcome.say(
        "Goal: in the first row at most 5 % for any law. C_post's fall and rise with current is in",
        "all rows, since the bend is common to all currents and the table is not.",
    )
    loops = campaign(RIVALS[-1], 0)
    short, whole = compared(loops).error, refitted(loops)
    outcome.numbers["one_step"] = {"step": short, "whole": whole}
    outcome.say(
        "Errors left out come from one Gauss–Newton step away from the fit to all tests. On a",
        f"campaign of the last row that gives {short:.3%} for straight lines, fits without each",
        f"pair {whole:.3%}.",
    )
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
