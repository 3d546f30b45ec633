"""A card as an FMU 2.0 for co-simulation: C source inside, and a binary for this platform."""

import hashlib
import io
import platform
import re
import sys
import zipfile
from dataclasses import dataclass
from typing import Final
from xml.sax.saxutils import quoteattr

from sysid.cards.doubts import doubts_of
from sysid.cards.export.box import conditions, not_told, ranges, unknown_temperature
from sysid.cards.export.c_program import c_program
from sysid.cards.export.c_source import Entry, entries_of
from sysid.cards.export.compiler import shared_library
from sysid.cards.export.pieces import Pieces
from sysid.cards.export.sources import filled
from sysid.cards.schema import Card

STARTED: Final = (1980, 1, 1, 0, 0, 0)
"""Date of all files in the archive, so that the same card gives the same bytes."""

_NO_XML: Final = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

INPUTS: Final = (
    ("displacement", "m", "of the piston from the centre of the motion, compression positive"),
    ("velocity", "m/s", "of the piston"),
    ("acceleration", "m/s2", "of the piston; used only where acceleration_known is true"),
    ("current", "A", "through the coil"),
    ("temperature", "degC", "of the damper; {} where it is not known"),
)


@dataclass(frozen=True)
class Fmu:
    """An FMU.

    Attributes:
        data: The archive.
        platform: Whose binary it has; None where no compiler was found.
        why: Why there is no binary.
    """

    data: bytes
    platform: str | None
    why: str | None = None


def fmu_of(card: Card, pieces: Pieces, name: str) -> Fmu:
    """Make the archive.

    Args:
        card: What is exported.
        pieces: Of its damper.
        name: Model identifier.
    """
    program = c_program(card, pieces, name)
    header, body = program[f"{name}.h"], program[f"{name}.c"]
    guid = _guid(header + body)
    marks = {
        "NAME": name,
        "UPPER": name.upper(),
        "GUID": guid,
        "UNKNOWN": repr(unknown_temperature(card, pieces)),
        **{n.upper(): told for n, told in ranges(card).items()},
    }
    source = f"{body}\n{filled('fmi2.c.in', marks)}"
    built, why = shared_library({f"{name}.h": header, f"{name}.c": source}, name, _suffix())
    files = {
        "modelDescription.xml": description(card, pieces, name, guid).encode(),
        f"sources/{name}.c": source.encode(),
        f"sources/{name}.h": header.encode(),
    }
    here = _platform()
    if built is not None:
        files[f"binaries/{here}/{name}{_suffix()}"] = built
    return Fmu(_zipped(files), here if built is not None else None, why)


def description(card: Card, pieces: Pieces, name: str, guid: str) -> str:
    """The text of modelDescription.xml."""
    entries = entries_of(pieces)
    units = sorted({unit for _, unit, _ in INPUTS} | {"N"} | {_unit(e) for e in entries})
    warm, identified = unknown_temperature(card, pieces), ranges(card)
    rows = [
        f'    <ScalarVariable name="{n}" valueReference="{k}" causality="input" '
        f'variability="continuous" description={_quoted(_described(told, warm, identified.get(n)))}'
        f'>\n      <Real start="{warm if n == "temperature" else 0.0:g}" unit={_quoted(unit)}/>\n'
        "    </ScalarVariable>\n"
        for k, (n, unit, told) in enumerate(INPUTS)
    ]
    rows.append(
        f'    <ScalarVariable name="force" valueReference="{len(INPUTS)}" causality="output" '
        'variability="continuous" initial="calculated" '
        'description="recorded force, positive where it resists compression">\n'
        '      <Real unit="N"/>\n    </ScalarVariable>\n'
    )
    outside = (
        "at the last sample an input was outside what the card was identified at (each input's "
        "description), so the force is extrapolated; 2 % and 2 K beyond count as inside. "
        f"It does not tell {not_told(card)}"
    )
    rows.append(
        '    <ScalarVariable name="outside_validity" valueReference="1" causality="output" '
        f'variability="discrete" initial="calculated" description={_quoted(outside)}>\n'
        "      <Boolean/>\n    </ScalarVariable>\n"
    )
    rows += [
        f"    <ScalarVariable name={_quoted(e.symbol)} "
        f'valueReference="{len(INPUTS) + 1 + k}" causality="parameter" variability="tunable" '
        f'initial="exact" description={_quoted(e.name)}>\n'
        f'      <Real start="{e.value!r}" unit={_quoted(_unit(e))}/>\n    </ScalarVariable>\n'
        for k, e in enumerate(entries)
    ]
    rows.append(
        '    <ScalarVariable name="acceleration_known" valueReference="0" causality="parameter" '
        'variability="fixed" initial="exact" description="false: acceleration is estimated by '
        'backward differences of the newest three velocities">\n'
        '      <Boolean start="false"/>\n    </ScalarVariable>\n'
    )
    first = len(INPUTS) + 1
    outputs = "".join(f'      <Unknown index="{first + k}"/>\n' for k in range(2))
    told = f"{card.damper.name}, identified from {card.damper.campaign} by {card.software}"
    told = ". ".join((told, f"Identified at {conditions(card)}", *doubts_of(card)))
    defined = "".join(f"    <Unit name={_quoted(unit)}/>\n" for unit in units)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<fmiModelDescription fmiVersion="2.0" modelName={_quoted(card.damper.name)} '
        f'guid="{guid}" description={_quoted(told)} generationTool={_quoted(card.software)} '
        'variableNamingConvention="flat" numberOfEventIndicators="0">\n'
        f'  <CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" '
        'canGetAndSetFMUstate="true" canSerializeFMUstate="true">\n'
        f'    <SourceFiles>\n      <File name="{name}.c"/>\n    </SourceFiles>\n'
        "  </CoSimulation>\n"
        f"  <UnitDefinitions>\n{defined}  </UnitDefinitions>\n"
        '  <LogCategories>\n    <Category name="logStatusWarning"/>\n'
        '    <Category name="outsideValidity" description="the first sample outside each condition '
        'that the card was identified in"/>\n  </LogCategories>\n'
        f'  <DefaultExperiment startTime="0" stopTime="{_seconds(card)}" stepSize="0.0002"/>\n'
        f"  <ModelVariables>\n{''.join(rows)}  </ModelVariables>\n"
        f"  <ModelStructure>\n    <Outputs>\n{outputs}    </Outputs>\n"
        f"    <InitialUnknowns>\n{outputs}    </InitialUnknowns>\n"
        "  </ModelStructure>\n</fmiModelDescription>\n"
    )


def _described(told: str, unknown: float, identified: str | None) -> str:
    """An input in words, with what it was in the card's tests."""
    told = told.format(f"{unknown:g}")
    return told if identified is None else f"{told}; identified: {identified}"


def _unit(entry: Entry) -> str:
    return "1" if entry.unit == "-" else entry.unit


def _seconds(card: Card) -> str:
    """Two cycles at the card's lowest frequency; at the highest where that is zero."""
    low, high = card.validity.frequency or (1.0, 1.0)
    return f"{2.0 / (low or high):g}"


def _quoted(text: str) -> str:
    """An attribute without the characters that XML 1.0 has no way to write."""
    return quoteattr(_NO_XML.sub("", text))


def _guid(text: str) -> str:
    digest = hashlib.sha256(text.encode()).hexdigest()
    return f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"


def _platform() -> str:
    system = {"linux": "linux", "darwin": "darwin", "win32": "win"}.get(sys.platform, sys.platform)
    machine = platform.machine().lower()
    if machine in ("x86_64", "amd64"):
        return f"{system}64"
    return f"{'aarch64' if machine == 'arm64' else machine}-{system}"


def _suffix() -> str:
    return {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")


def _zipped(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            info = zipfile.ZipInfo(name, STARTED)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    return buffer.getvalue()
