"""A campaign's inspection as tables and sentences for people."""

from collections.abc import Callable, Iterator

import pandas as pd
from rich.markup import escape
from rich.table import Table

from sysid.cli.soundness import not_a_loop, spoils
from sysid.data.conformity import Conformity
from sysid.data.descriptors import Descriptors
from sysid.data.figures import current_figures, figure
from sysid.data.quality import QualityReport
from sysid.data.quality.matrix import is_one_setting
from sysid.data.quality.sign import NO_DAMPER


def matrix_table(matrix: pd.DataFrame) -> Table:
    """Temperature, amplitude and frequency down, current across; "–" where missing.

    A single temperature stands in the title.  Where levels cannot be told, as in a sweep, their
    range stands in their place: ``11–75 °C``.
    """
    by_temperature = list(matrix.groupby("temperature_degC", dropna=False, sort=True))
    warm = [
        _levels(part.iloc[:1], "temperature_degC", lambda z: [figure(t, 3) for t in z])[0]
        for _, part in by_temperature
    ]
    several = len(warm) > 1
    title = "Tests" if several or warm in ([], ["?"]) else f"Tests at {warm[0]} °C"
    table = Table(title=title, caption="number of tests; – where a combination is missing")
    for name in ("T / °C",) * several + ("amplitude / mm", "frequency / Hz"):
        table.add_column(name, justify="right")
    currents = matrix.drop_duplicates("current_A")
    unit, _ = current_figures(list(currents["highest_current_A"]))
    for shown in _levels(currents, "current_A", lambda z: current_figures(z)[1]):
        table.add_column(f"{shown} {unit}", justify="right")
    for shown, (_, part) in zip(warm, by_temperature, strict=True):
        for _, row in part.groupby(["amplitude_m", "frequency_Hz"], dropna=False):
            counts = [int(n) for n in row["tests"]]
            if any(counts):
                one = row.iloc[:1]
                (a,) = _levels(one, "amplitude_m", lambda z: [figure(1e3 * x, 3) for x in z])
                (f,) = _levels(one, "frequency_Hz", lambda z: [figure(x, 3) for x in z])
                table.add_row(*(shown,) * several, a, f, *(str(n) if n else "–" for n in counts))
    return table


def _levels(
    rows: pd.DataFrame, name: str, figures: Callable[[list[float]], list[str]]
) -> list[str]:
    """Levels of a condition for people: one value, or a range where settings cannot be told."""
    middle, low, high = (list(rows[f"{end}{name}"]) for end in ("", "lowest_", "highest_"))
    shown = figures([*low, *high, *middle])
    count = len(middle)
    return [
        shown[2 * count + k]
        if is_one_setting(name, low[k], high[k])
        else f"{shown[k]}–{shown[count + k]}"
        for k in range(count)
    ]


def quality_table(report: QualityReport) -> Table:
    """One row a test: conditions as measured, cycles, repeatability, kinds of faults."""
    table = Table(title=f"{escape(report.name)}: tests as measured")
    table.add_column("test", overflow="fold")
    tests = sorted(report.tests, key=lambda test: test.id)
    unit, currents = current_figures([test.current for test in tests])
    heads = ("A / mm", "f / Hz", f"i / {unit}", "T / °C", "cycles", "max|F| / N")
    for name in (*heads, "repeatability / N"):
        table.add_column(name, justify="right", overflow="fold")
    table.add_column("faults")
    for test, current in zip(tests, currents, strict=True):
        amplitude = None if test.amplitude is None else 1e3 * test.amplitude
        faults = ", ".join(dict.fromkeys(f.kind for f in test.faults if f.severity != "note"))
        table.add_row(
            escape(test.id),
            _number(amplitude),
            _number(test.frequency),
            current,
            _number(test.temperature),
            str(test.cycles),
            _number(test.peak_force),
            _number(test.noise_floor),
            faults,
        )
    return table


def descriptor_table(read: Descriptors) -> Table:
    """What damper people read off a loop; "?" where a loop has no such thing."""
    table = Table(
        title="Read off the loops",
        caption="γ: rebound over compression; width: at zero force; C_eq = E/(πωA²)",
    )
    table.add_column("test", overflow="fold")
    columns = {
        "compression / N": read.peak_compression,
        "rebound / N": read.peak_rebound,
        "γ": read.asymmetry,
        "energy / J": read.energy,
        "C_eq / (N·s/m)": read.equivalent_damping,
        "gas force / N": read.gas_force,
        "width / (m/s)": read.velocity_width,
        "knee / (m/s)": read.knee_velocity,
        "yield force / N": read.yield_force,
    }
    for name in columns:
        table.add_column(name, justify="right", overflow="fold")
    for k in sorted(range(len(read.ids)), key=lambda k: read.ids[k]):
        table.add_row(escape(read.ids[k]), *(_number(float(z[k])) for z in columns.values()))
    return table


def tolerance_table(judged: Conformity) -> Table:
    """Tests for which the damper's drawing has a line, those that do not conform first."""
    table = Table(title="Peak forces against the drawing (campaign.toml)")
    table.add_column("test", overflow="fold")
    table.add_column("line", justify="right")
    table.add_column("verdict")
    order = {"outside": 0, "open": 1, "inside": 2}
    for test in sorted(judged.tests, key=lambda j: (order[j.verdict], j.place, j.id)):
        table.add_row(escape(test.id), str(test.place + 1), escape(test.text))
    return table


def fault_lines(report: QualityReport) -> Iterator[str]:
    """What a fit lacks, fatal faults and warnings one by one with evidence; notes once a kind."""
    damped = [test for test in report.tests if test.kind not in NO_DAMPER]
    silent = [test.id for test in damped if test.current is None]
    if silent:
        yield (
            f"the current of {len(silent)} of {len(damped)} tests is not known "
            f"({', '.join(silent[:3])}{', …' if silent[3:] else ''}), and a fit needs it: give a "
            "column current_A, or tell it in file names, in tests.csv or in campaign.toml"
        )
    for test in report.tests:
        if not_a_loop(test) is not None:
            yield f"{test.id}: {test.left_out}; left out of fits"
    for severity in ("fatal", "warning"):
        for test in report.tests:
            for fault in test.faults:
                if fault.severity == severity:
                    out = "; left out of fits" if spoils(fault) else ""
                    yield f"{severity}: {test.id}: {fault.kind}: {fault.evidence}{out}"
    noted: dict[str, list[str]] = {}
    for test in report.tests:
        for fault in test.faults:
            if fault.severity == "note":
                noted.setdefault(fault.kind, []).append(f"{test.id}: {fault.evidence}")
    for kind, found in sorted(noted.items()):
        more = f" (and {len(found) - 1} more; all with --json)" if found[1:] else ""
        yield f"note: {kind}: {found[0]}{more}"


def _number(value: float | None) -> str:
    return "?" if value is None else figure(value)
