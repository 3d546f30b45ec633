"""`sysid rig`: run a virtual campaign of tests and write it as a rig would."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from sysid.cli.console import Talk
from sysid.cli.options import Json, Quiet
from sysid.errors import OutputError


def rig(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO",
            help="virtual-w11-low, virtual-w11-high, virtual-w11-asymmetric, "
            "virtual-asymmetric, virtual-bs09, virtual-bs09-frequency, "
            "virtual-bs09-heating, physical-matrix-165 or physical-sweep.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder for the campaign, new or empty."
        ),
    ],
    json: Json = False,
    seed: Annotated[
        int | None,
        typer.Option("--seed", min=0, help="Other random errors; without it, the shipped data."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Test a virtual damper whose truth is known: raw files, manifest, sealed truth."""
    from sysid.rig.campaign import make_campaign
    from sysid.rig.folder import write_folder
    from sysid.rig.scenarios import find_scenario
    from sysid.rig.truth import SEAL_FILE

    talk = Talk(json, quiet)
    chosen = find_scenario(scenario)
    with talk.progress(f"Testing {chosen.title}"):
        files = make_campaign(chosen, seed)
        if not (output / SEAL_FILE).exists():
            _refuse_measured(files, output)
        write_folder(files, output)
    size = sum(len(content) for content in files.values())
    talk.say(
        f"{output}: {len(chosen.settings)} tests of {chosen.title!r}, {size / 1e6:.2f} MB; "
        f"the truth is sealed in {SEAL_FILE}"
    )
    talk.result(
        {
            "scenario": chosen.id,
            "folder": str(output),
            "seed": chosen.seed if seed is None else seed,
            "tests": len(chosen.settings),
            "bytes": size,
            "sealed": SEAL_FILE,
        }
    )


def _refuse_measured(names: Iterable[str], output: Path) -> None:
    """Files of these names without a seal beside them are somebody's measurements."""
    held = next((name for name in names if (output / name).exists()), None)
    if held is not None:
        raise OutputError(
            f"the folder holds {held!r}, which no virtual campaign left there",
            where=output,
            advice="Give an empty or new folder with -o",
        )
