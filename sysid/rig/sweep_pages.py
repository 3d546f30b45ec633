"""The texts beside a virtual sweep over temperature: `campaign.toml` and the dataset's page."""

from textwrap import fill

from sysid.rig.manifest_text import manifest_text
from sysid.rig.sweep import Sweep


def sweep_manifest(sweep: Sweep) -> str:
    """`campaign.toml` with the limits of BS09's damper and rig."""
    told = "" if any(setting.wanders for setting in sweep.settings) else "_{temperature}C"
    highest = max(1.0, *(setting.current for setting in sweep.settings))
    return manifest_text(
        sweep.title,
        f"{{amplitude}}mm_{{frequency}}Hz_{{current}}A{told}",
        f"""\
stroke = {{ value = 53, unit = "mm" }}       # of the damper, from end to end
velocity = {{ value = 1.0, unit = "m/s" }}   # of BS09's actuator
current = {{ value = {highest:g}, unit = "A" }}""",
    )


def sweep_page(sweep: Sweep, seed: int, digest: str) -> str:
    """README of a dataset: origin, what is in it, how to rebuild it; the truth stays sealed."""
    option = "" if seed == sweep.seed else f" --seed {seed}"
    return f"""\
# {sweep.title}

{fill(f"Virtual data: made by `sysid rig`, not measured. {sweep.about}", 100)}

BS09 is C. K. Batterbee and N. D. Sims, *Temperature sensitive controller performance of MR
dampers* (2009).

## Files

{fill(_files(sweep), 100)}

{fill(_between(sweep), 100)}

On the piston there is besides the force of a gas accumulator, a constant at a given temperature
that grows with absolute temperature; the paper sees it and leaves it out of its model.

## Imperfections

{_imperfections(sweep)}

What was drawn for each test, and the damper's parameters, are in `sealed/truth.json` as base64
text, where no fit reads them. `sysid.rig.truth.open_seal` opens it.

    sha256 of what is sealed: {digest}

## Rebuild

    sysid rig {sweep.id} -o datasets/{sweep.id}{option}

gives these files byte for byte. Nothing in the way there depends on a machine: random numbers are
sums of raw integers of a seeded PCG64, the damper is stepped by sums, products and quotients, and
sines are series of them. What would break it: arithmetic that is not IEEE 754 double precision, a
compiler that fuses multiplications with additions, or a change of the rig itself.
"""


def _files(sweep: Sweep) -> str:
    plans = {setting.plan for setting in sweep.settings}
    steady = sorted(plan.steady for plan in plans)
    cycles = f"{steady[0]:g}" + (f" to {steady[-1]:g}" if len(steady) > 1 else "")
    plan = sweep.settings[0].plan
    rates = sorted({setting.rate / setting.frequency for setting in sweep.settings})
    samples = f"{rates[0]:g}" + (f" to {rates[-1]:g}" if len(rates) > 1 else "")
    return (
        f"One test a file, {len(sweep.settings)} tests, raw: rest, {_cycles(plan.ramp_up)} of "
        f"rising amplitude, {cycles} steady cycles, {_cycles(plan.ramp_down)} of falling "
        "amplitude, rest; "
        f"{samples} samples a cycle. `tests.csv` lists conditions and the order in which the "
        "tests were run, `campaign.toml` says what the columns mean; the default reading without "
        "it gives the same. A temperature in a file's name is that at which the test was to start, "
        "the column is what the thermometer showed. Compression is positive, and force is "
        "positive where it resists compression. The damper starts each test from rest with a "
        "relaxed spring. The current is constant through a file."
    )


def _cycles(count: float) -> str:
    return f"{count:g} cycle" + ("s" if count > 1.0 else "")


def _between(sweep: Sweep) -> str:
    heat, operator = sweep.heat, sweep.operator
    return (
        f"The damper heats by its own work: heat capacity {heat.capacity:g} J/K, "
        f"{heat.loss:g} W/K to a room at {heat.ambient:g} °C. Between two tests it rests for "
        f"{operator.pause:g} s. If it is then more than {operator.tolerance:g} K from where the "
        "next test is to start, it is brought there within a standard deviation of "
        f"{operator.scatter:g} K."
    )


def _imperfections(sweep: Sweep) -> str:
    bench = sweep.bench
    harmonics = f"2nd {100 * bench.second_harmonic:g} %, 3rd {100 * bench.third_harmonic:g} %"
    reached = f"{100 * bench.amplitude_sd:g} % and {100 * bench.frequency_sd:g} %"
    rows = {
        "force noise, per sample": f"{100 * bench.force_noise:g} % of the RMS force in the test's "
        "steady cycles",
        "force gain, per test": f"{100 * bench.gain_sd:g} % standard deviation",
        "force offset, per test": f"{bench.offset_sd:g} N standard deviation",
        "delay of force against displacement, per test": f"{1e3 * bench.delay_sd:g} ms standard "
        "deviation",
        "displacement noise, per sample": f"{1e6 * bench.displacement_noise:g} µm",
        "actuator harmonics": f"{harmonics} of the displacement, phases differ by test",
        "stroke and frequency reached, per test": f"{reached} standard deviation",
        "centre of the displacement": f"{1e3 * bench.centre:g} mm, {1e3 * bench.centre_sd:g} mm "
        "standard deviation",
        "thermometer": f"{sweep.thermometer_sd:g} K standard deviation by test, "
        f"{bench.temperature_noise:g} K by sample, {sweep.heat.lag:g} s late",
        "last digits": "1 µm, 0.1 N, 1 mA, 0.1 °C",
    }
    lines = [f"| {what} | {size} |" for what, size in rows.items()]
    return "\n".join(["| | size |", "|---|---|", *lines])
