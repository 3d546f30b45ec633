"""README of a physical campaign: origin, what is in it, how to rebuild it; the truth is sealed."""

from textwrap import fill

from sysid.rig.physical.campaign import PhysicalCampaign


def physical_page(campaign: PhysicalCampaign, seed: int, digest: str) -> str:
    """The text.

    Args:
        campaign: What was run.
        seed: Of its random numbers.
        digest: SHA-256 of what is sealed.
    """
    option = "" if seed == campaign.seed else f" --seed {seed}"
    return f"""\
# {campaign.title}

{fill(f"Virtual data: made by `sysid rig`, not measured. {campaign.about}", 100)}

The damper is a differential equation of thirteen unknowns that shares nothing with the models that
are fitted: `docs/physical-damper.md` has its equations and constants.

## Files

{fill(_files(campaign), 100)}

## Protocol

{fill(_protocol(campaign), 100)}

## Imperfections

{_imperfections(campaign)}

What was drawn for each test, every constant and the level of every mechanism are in
`sealed/truth.json` as base64 text, where no fit reads them. `sysid.rig.truth.open_seal` opens it.

    sha256 of what is sealed: {digest}

## Rebuild

    sysid rig {campaign.id} -o datasets/{campaign.dataset}{option}

Steps are fixed and Newton's iteration is taken to its end, so that what another processor or
another grouping of the tests rounds otherwise stays far below the last digit written; how far is
measured in `benchmarks/results/rebuild_elsewhere.md`.
"""


def _files(campaign: PhysicalCampaign) -> str:
    plan = campaign.plan
    return (
        f"One test a file, {len(campaign.settings)} tests, raw: rest, {plan.ramp_up:g} cycles of "
        f"rising amplitude, {plan.steady:g} steady cycles, {plan.ramp_down:g} cycle of falling "
        "amplitude, rest. `tests.csv` lists conditions and the order in which the tests were run, "
        "`campaign.toml` says what the columns mean. Displacement is that of the actuator's ram, "
        "force that of the load cell, temperature that of a thermocouple on the body. Compression "
        "is positive, and force is positive where it resists compression; the force of the gas on "
        "the rod is in it. The current is constant through a file."
    )


def _protocol(campaign: PhysicalCampaign) -> str:
    operator = campaign.operator
    return (
        f"Before each test the damper is worked at {operator.power:g} W of heat, or its body "
        f"cooled by {operator.cooling:g} W/K towards {operator.coolant:g} °C, until the "
        "thermocouple shows the temperature of the test within a standard deviation of "
        f"{operator.scatter:g} K, never more than {operator.window:g} K off. "
        "The oil is then warmer than the body after working, and "
        "after cooling too. Between two tests the current is off; the iron remembers the last."
    )


def _imperfections(campaign: PhysicalCampaign) -> str:
    bench, chain = campaign.bench, campaign.channels
    rows = {
        "force noise, per sample": f"{chain.force_noise:g} N",
        "force converter": f"{chain.bits} bits over ±{1e-3 * chain.force_range:g} kN",
        "force conditioner": f"second order, {chain.force_corner:g} Hz",
        "displacement conditioner": f"second order, {chain.displacement_corner:g} Hz",
        "displacement noise, per sample": f"{1e6 * chain.displacement_noise:g} µm",
        "force gain, per test": f"{100 * bench.gain_sd:g} % standard deviation",
        "force offset, per test": f"{bench.offset_sd:g} N standard deviation",
        "delay of force, per test": f"{1e3 * bench.delay_sd:g} ms standard deviation",
        "actuator's command": f"2nd harmonic {100 * bench.second_harmonic:g} %, 3rd "
        f"{100 * bench.third_harmonic:g} %; the force bends its motion further",
        "stroke and frequency reached": f"{100 * bench.amplitude_sd:g} % and "
        f"{100 * bench.frequency_sd:g} % standard deviation",
        "centre": f"{1e3 * bench.centre:g} mm, {1e3 * bench.centre_sd:g} mm standard deviation",
        "thermocouple": f"{campaign.thermometer_sd:g} K standard deviation by test, "
        f"{chain.temperature_noise:g} K by sample, late",
        "last digits": "1 µm, 0.1 N, 1 mA, 0.1 °C",
    }
    return "\n".join(["| | size |", "|---|---|", *(f"| {k} | {v} |" for k, v in rows.items())])
