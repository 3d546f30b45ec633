"""The texts beside virtual data: `campaign.toml` and the page that says where they come from."""

from textwrap import fill

from sysid.rig.bench import RAMP_DOWN, RAMP_UP, STEADY
from sysid.rig.manifest_text import manifest_text
from sysid.rig.scenario import Scenario


def scenario_manifest(scenario: Scenario) -> str:
    """`campaign.toml` with the limits of W11's damper and rig."""
    return manifest_text(
        scenario.title,
        "{amplitude}mm_{frequency}Hz_{current}A",
        """\
stroke = { value = 200, unit = "mm" }      # of the damper, from end to end
velocity = { value = 1.6, unit = "m/s" }   # fastest test of W11's Table 1: 50 mm, 5 Hz
current = { value = 0.5, unit = "A" }""",
    )


def dataset_page(scenario: Scenario, seed: int, digest: str) -> str:
    """README of a dataset: origin, what is in it, how to rebuild it; the truth stays sealed."""
    bench = scenario.bench
    option = "" if seed == scenario.seed else f" --seed {seed}"
    return f"""\
# {scenario.title}

{fill(f"Virtual data: made by `sysid rig`, not measured. {scenario.about}", 100)}

W11 is *Characterization and Modeling of Symmetric and Asymmetric Damping Properties of a
Magnetorheological Damper*.

## Files

One test a file, {len(scenario.settings)} tests, raw: rest, {RAMP_UP:g} cycles of rising \
amplitude, {STEADY:g} steady cycles, {RAMP_DOWN:g} cycle
of falling amplitude, rest. `tests.csv` lists conditions and the order in which the tests were run,
`campaign.toml` says what the columns mean; the default reading without it gives the same.
Compression is positive, and force is positive where it resists compression. The current is
constant through a file.

In the ramps the force follows the same equations with v_m taken as ω times the momentary amplitude
of the fundamental; at rest v_m = 0. The sign of the acceleration (W11 Eq. 7) is minus the sign of
the displacement's fundamental everywhere, 0 at rest. Where it changes, at the peaks of velocity,
the published equations make the force jump at high currents; so do these data.

## Imperfections

| | size |
|---|---|
| force noise, per sample | {100 * bench.force_noise:g} % of the RMS force in the test's \
steady cycles |
| force gain, per test | {100 * bench.gain_sd:g} % standard deviation |
| force offset, per test | {bench.offset_sd:g} N standard deviation |
| delay of force against displacement, per test | {1e3 * bench.delay_sd:g} ms standard deviation |
| displacement noise, per sample | {1e6 * bench.displacement_noise:g} µm |
| actuator harmonics | 2nd {100 * bench.second_harmonic:g} %, 3rd {100 * bench.third_harmonic:g} % \
of the displacement, phases differ by test |
| stroke and frequency reached, per test | {100 * bench.amplitude_sd:g} % and \
{100 * bench.frequency_sd:g} % standard deviation |
| centre of the displacement | {1e3 * bench.centre:g} mm, {1e3 * bench.centre_sd:g} mm standard \
deviation |
| temperature | {bench.temperature:g} °C, {bench.temperature_sd:g} K standard deviation by test, \
rising {bench.heating:g} K in a test; the force does not depend on it |
| last digits | 1 µm, 0.1 N, 1 mA, 0.1 °C |

What was drawn for each test, and the damper's parameters, are in `sealed/truth.json` as base64
text, where no fit reads them. `sysid.rig.truth.open_seal` opens it.

    sha256 of what is sealed: {digest}

## Rebuild

    sysid rig {scenario.id} -o datasets/{scenario.id}{option}

gives these files byte for byte. Nothing in the way there depends on a machine: random numbers are
sums of raw integers of a seeded PCG64, exponentials and sines are series of exactly rounded
operations. What would break it: arithmetic that is not IEEE 754 double precision, a compiler that
fuses multiplications with additions inside numpy, or a change of the rig itself.
"""
