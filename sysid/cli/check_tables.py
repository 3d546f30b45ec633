"""A campaign's inspection as tables and sentences for people."""

import math
from collections.abc import Iterator

import pandas as pd
from rich.markup import escape
from rich.table import Table

from sysid.cli.soundness import not_a_loop, spoils
from sysid.data.conformity import Conformity
from sysid.data.descriptors import Descriptors
from sysid.data.figures import current_figures, figure
from sysid.data.quality import QualityReport


def matrix_tables(matrix: pd.DataFrame) -> Iterator[Table]:
    """Amplitude and frequency down, current across, one table a temperature; "–" where missing."""
    for temperature, part in matrix.groupby("temperature_degC", dropna=False, sort=True):
        known = math.isfinite(float(str(temperature)))
        title = f"Tests at {float(str(temperature)):.3g} °C" if known else "Tests"
        table = Table(title=title, caption="number of tests; – where a combination is missing")
        table.add_column("amplitude / mm", justify="right")
        table.add_column("frequency / Hz", justify="right")
        currents = list(dict.fromkeys(part["current_A"]))
        unit, shown_currents = current_figures(currents)
        for shown_current in shown_currents:
            table.add_column(f"{shown_current} {unit}", justify="right")
        for keys, row in part.groupby(["amplitude_m", "frequency_Hz"], dropna=False):
            counts = [int(n) for n in row["tests"]]
            if any(counts):
                a, f = (float(str(z)) for z in (keys if isinstance(keys, tuple) else (keys,)))
                shown = (str(n) if n else "–" for n in counts)
                table.add_row(figure(1e3 * a, 3), figure(f, 3), *shown)
        yield table


def quality_table(report: QualityReport) -> Table:
    """One row a test: conditions as measured, cycles, noise floor, kinds of faults."""
    table = Table(title=f"{escape(report.name)}: tests as measured")
    table.add_column("test", overflow="fold")
    tests = sorted(report.tests, key=lambda test: test.id)
    unit, currents = current_figures([test.current for test in tests])
    heads = ("A / mm", "f / Hz", f"i / {unit}", "T / °C", "cycles", "max|F| / N", "noise floor / N")
    for name in heads:
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
    """Fatal faults and warnings one by one with their evidence; notes once a kind."""
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
