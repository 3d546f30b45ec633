"""`sysid check`: what is in a campaign, and whether it is sound."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.options import (
    CampaignArgument,
    FlipForce,
    Json,
    ManifestOption,
    Quiet,
    UnusedSeed,
)

if TYPE_CHECKING:
    from sysid.data.campaign import Campaign
    from sysid.data.conformity import Conformity
    from sysid.data.quality import QualityReport


def check(
    campaign: CampaignArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Folder for check.json and a picture of the loops.",
        ),
    ] = None,
    flip_force: FlipForce = False,
    manifest: ManifestOption = None,
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Check a campaign: test matrix, repeatability, faults with evidence, what the loops say.

    Nothing is changed. Exit code 3 where a fault makes a fit meaningless.
    """
    talk = Talk(json, quiet)

    from sysid.cli.without_damper import told_without_damper
    from sysid.data.campaign import load_campaign
    from sysid.data.quality import inspect
    from sysid.data.whole_file import need_writable

    if output is not None:
        need_writable(output)
    with talk.progress(f"Reading {campaign}"):
        loaded = load_campaign(campaign, manifest, flip_force=flip_force)
        report = inspect(loaded)
    without = told_without_damper(loaded.records)
    talk.notes((*loaded.notes, *without))
    judged = _judged(loaded, report)
    result = check_json(loaded, report, judged, without)
    files = [] if output is None else _write(output, report, result)
    if not talk.json:
        _show(talk, report, judged)
    if output is not None:
        talk.say(f"Written to {output}: {', '.join(files)}")
    talk.result(result)
    if not report.trustworthy:
        talk.distrust(report.untrusted)
        raise typer.Exit(3)


def check_json(
    campaign: "Campaign",
    report: "QualityReport",
    judged: "Conformity | None",
    remarks: tuple[str, ...] = (),
) -> dict[str, Any]:
    """The machine-readable result: conditions as measured, repeatability, faults, descriptors.

    Args:
        campaign: As read.
        report: Its inspection.
        judged: Its tests against the damper's drawing; None where there is none.
        remarks: Notes besides those of the reading.
    """
    from sysid.cli.soundness import unfit
    from sysid.data.descriptors import describe
    from sysid.report.fit_json import known

    faulty = unfit(report)
    descriptors = {
        str(name): {str(key): known(float(value)) for key, value in row.items()}
        for name, row in describe(report.cut.loops).to_frame().iterrows()
    }
    matrix = report.matrix()
    names = ["amplitude_m", "frequency_Hz", "current_A", "temperature_degC"]
    missing = matrix.loc[matrix["tests"] == 0, names]
    return {
        "schema": "sysid-check-1",
        "campaign": campaign.name,
        "tests": [
            {
                **test.to_dict(),
                "unfit": faulty.get(test.id),
                "descriptors": descriptors.get(test.id),
            }
            for test in sorted(report.tests, key=lambda test: test.id)
        ],
        "missing": [
            {
                key: None if math.isnan(value) else value
                for key, value in zip(names, row, strict=True)
            }
            for row in missing.to_numpy(dtype=float).tolist()
        ],
        "tolerance": None
        if judged is None
        else {
            "sentence": judged.sentence,
            "tests": [
                {"id": j.id, "line": j.place + 1, "verdict": j.verdict, "words": j.words}
                for j in judged.tests
            ],
            "lines_untested": [place + 1 for place in judged.untested],
            "not_judged": [
                {"id": n.id, "line": n.place + 1, "temperature_degC": n.temperature}
                for n in judged.not_judged
            ],
        },
        "trustworthy": report.trustworthy,
        "distrust": list(report.untrusted),
        "notes": [*campaign.notes, *remarks],
    }


def _judged(campaign: "Campaign", report: "QualityReport") -> "Conformity | None":
    """Peak forces against what the manifest allows."""
    from sysid.data.conformity import conformity, loop_peaks

    tolerance = campaign.manifest.tolerance.si()
    if tolerance is None:
        return None
    loops = report.cut.loops
    return conformity(tolerance, loop_peaks(loops) if loops.ids else ())


def _show(talk: Talk, report: "QualityReport", judged: "Conformity | None") -> None:
    from sysid.cli.check_tables import (
        descriptor_table,
        fault_lines,
        matrix_table,
        quality_table,
        tolerance_table,
    )
    from sysid.data.descriptors import describe

    if report.cut.loops.ids:
        talk.show(matrix_table(report.matrix()))
    talk.show(quality_table(report))
    if report.cut.loops.ids:
        talk.show(descriptor_table(describe(report.cut.loops)))
    if judged is not None:
        if judged.tests:
            talk.show(tolerance_table(judged))
        talk.say(judged.sentence)
    for line in fault_lines(report):
        talk.say(line)


def _write(output: Path, report: "QualityReport", result: dict[str, Any]) -> dict[str, bytes]:
    from sysid.cards.write import json_text
    from sysid.data.whole_file import write_files
    from sysid.report.loop_plots import loops_png

    files = {"check.json": json_text(result).encode()}
    if report.cut.loops.ids:
        files["loops.png"] = loops_png(report.cut.loops, report.name)
    write_files(files, output)
    return files
