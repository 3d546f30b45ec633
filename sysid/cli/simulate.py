"""`sysid simulate`: the force of an identified damper on a motion."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from sysid.cli.console import Talk
from sysid.cli.options import CardArgument, Json, Quiet, UnusedSeed, quantity
from sysid.errors import DataError, OutputError

if TYPE_CHECKING:
    import numpy as np

    from sysid.cards.schema import Card
    from sysid.data.motion_file import MotionFile
    from sysid.motion.motion import Motion

RATE: Final = (0.5, 2.0)
"""Parts of the displacement's rate between which a column of velocity may lie, and of the
velocity's rate between which one of acceleration may: filters and delays take a few per cent, a
wrong unit or sign much more."""
ALIKE: Final = 0.5
"""Least correlation, of either sign, of a column and such a rate that tells their ratio; below it
noise has the say."""


@dataclass(frozen=True)
class Case:
    """What is to be simulated.

    Attributes:
        time: [n] s.
        motion: Arrays [n].
        outside: Respects in which it leaves the card's validity box.
        notes: What the user should know of how it was read.
    """

    time: "np.ndarray"
    motion: "Motion"
    outside: tuple[str, ...]
    notes: tuple[str, ...] = ()


def simulate(
    card: CardArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE", help="The force.csv to write.")
    ],
    motion: Annotated[
        Path | None,
        typer.Option(
            "--input", metavar="FILE", help="A motion: time, displacement, current, … as columns."
        ),
    ] = None,
    causal: Annotated[
        bool,
        typer.Option(
            "--causal",
            help="Velocity and acceleration that the file does not hold from past samples only "
            "(three-point backward differences), as exported models do.",
        ),
    ] = False,
    centre: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Where the centre of the motion is in the file's displacement, with the file's "
            "sign. \\[default: 0mm]",
        ),
    ] = None,
    amplitude: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Of a steady sinusoid, e.g. 12.5mm.")
    ] = None,
    frequency: Annotated[
        str | None, typer.Option(metavar="FREQUENCY", help="Of a steady sinusoid, e.g. 1.5Hz.")
    ] = None,
    current: Annotated[
        str | None,
        typer.Option(metavar="CURRENT", help="E.g. 0.2A; with --input where it has no column."),
    ] = None,
    temperature: Annotated[
        str | None,
        typer.Option(metavar="TEMPERATURE", help="E.g. 40C; with --input where it has no column."),
    ] = None,
    manifest: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="A campaign.toml that names the columns of --input otherwise."
        ),
    ] = None,
    json: Json = False,
    seed: UnusedSeed = 0,
    quiet: Quiet = False,
) -> None:
    """Simulate the force of a damper on a motion, or on one cycle of a steady sinusoid.

    Exit code 3 where the motion leaves the conditions that the card was identified in.
    """
    talk = Talk(json, quiet)
    constant = {
        "current": None if current is None else quantity(current, "current", "--current"),
        "temperature": None
        if temperature is None
        else quantity(temperature, "temperature", "--temperature"),
    }
    sine = _sine_asked(motion, amplitude, frequency, current, causal, centre, manifest)
    _refuse_inputs(output, card, motion, manifest)
    offset = 0.0 if centre is None else quantity(centre, "displacement", "--centre")

    from sysid.cards.idle import assumed_temperature, idle_effects
    from sysid.cards.read import read_card
    from sysid.cards.verify import verify
    from sysid.cli.compile_cache import keep_compiled
    from sysid.cli.doubted import told_of_doubts

    parsed = read_card(card, check=False)
    doubted = told_of_doubts(talk, parsed, card)
    keep_compiled(talk)
    damper = verify(parsed, where=str(card))
    assumed = assumed_temperature(damper)
    if sine is not None:
        case = _sine_case(
            parsed, *sine, constant["current"] or 0.0, constant["temperature"], assumed
        )
    else:
        assert motion is not None
        file, side = _read(motion, manifest)
        case = _file_case(parsed, file, motion, constant, offset, side, causal, assumed)

    import numpy as np

    from sysid.data.whole_file import write_text
    from sysid.models.simulate import simulate as force_of

    force = np.asarray(force_of(damper, case.motion))
    _need_finite(force, motion, case.time)
    write_text(output, force_csv(case.time, case.motion, force))
    notes = (*case.notes, *idle_effects(damper, case.motion))
    talk.notes(notes)
    talk.say(f"{output}: {force.size} points, force {force.min():.4g} to {force.max():.4g} N")
    talk.result(
        {
            "file": str(output),
            "points": int(force.size),
            "force_min_N": float(force.min()),
            "force_max_N": float(force.max()),
            "inside_validity": not case.outside,
            "outside": list(case.outside),
            "notes": [*doubted, *notes],
        }
    )
    if case.outside:
        talk.distrust(f"{reason} (the card's validity)" for reason in case.outside)
        raise typer.Exit(3)


def _sine_asked(
    motion: Path | None,
    amplitude: str | None,
    frequency: str | None,
    current: str | None,
    causal: bool,
    centre: str | None,
    manifest: Path | None,
) -> tuple[float, float] | None:
    """Amplitude and frequency, None where a file is given; anything between is wrong usage."""
    if motion is not None:
        if amplitude is not None or frequency is not None:
            raise typer.BadParameter("give either --input, or --amplitude and --frequency")
        return None
    if amplitude is None or frequency is None or current is None:
        raise typer.BadParameter(
            "give --input motion.csv, or all of --amplitude, --frequency and --current"
        )
    if causal or centre is not None or manifest is not None:
        raise typer.BadParameter("--causal, --centre and --manifest go with --input only")
    a = quantity(amplitude, "displacement", "--amplitude")
    f = quantity(frequency, "frequency", "--frequency")
    for value, text, option in ((a, amplitude, "--amplitude"), (f, frequency, "--frequency")):
        if value <= 0.0:
            raise typer.BadParameter(f"{text!r} is not positive", param_hint=option)
    return a, f


def _refuse_inputs(output: Path, *inputs: Path | None) -> None:
    """Refuse to write over what is read, or into what is no file."""
    if output.exists() and not output.is_file():
        raise OutputError("is no file", where=output, advice="Give the name of a file with -o")
    for path in inputs:
        if path is not None and path.exists() and output.exists() and output.samefile(path):
            raise OutputError(
                "is read by this very command", where=output, advice="Give another file with -o"
            )


def _sine_case(
    card: "Card",
    amplitude: float,
    frequency: float,
    current: float,
    temperature: float | None,
    assumed: float | None,
) -> Case:
    """One cycle of a steady sinusoid, 360 points."""
    import jax
    import numpy as np

    from sysid.cards.outside import outside
    from sysid.motion.motion import sine_motion

    t = np.nan if temperature is None else temperature
    a, f, i, t = (np.array([z]) for z in (amplitude, frequency, current, t))
    motion = jax.tree.map(lambda z: z[0], sine_motion(a, f, i, t))
    time = np.arange(motion.displacement.size) / (motion.displacement.size * frequency)
    warm = assumed if temperature is None else temperature
    told = outside(
        card.validity,
        amplitude=amplitude,
        frequency=frequency,
        velocity=2.0 * np.pi * frequency * amplitude,
        current=(current, current),
        temperature=None if warm is None else (warm, warm),
    )
    return Case(time, motion, told)


def _read(path: Path, manifest: Path | None) -> tuple["MotionFile", float]:
    """The motion, compression positive, and −1 where the file's displacement was not, else 1."""
    from sysid.data.manifest import read_manifest
    from sysid.data.motion_file import read_motion

    said = None if manifest is None else read_manifest(manifest)
    turned = said is not None and said.campaign.positive_displacement == "extension"
    return read_motion(path, said), -1.0 if turned else 1.0


def _file_case(
    card: "Card",
    file: "MotionFile",
    path: Path,
    constant: dict[str, float | None],
    centre: float,
    side: float,
    causal: bool,
    assumed: float | None,
) -> Case:
    """A motion from a file; its centre, m, has the file's sign, which `side` turns (`_read`)."""
    from sysid.cards.motion_box import motion_outside
    from sysid.motion.time_motion import time_motion

    for name, value in constant.items():
        if value is not None and getattr(file, name) is not None:
            raise typer.BadParameter(f"{path} has a column for {name}; leave --{name} out")
    i = constant["current"] if file.current is None else file.current
    if i is None:
        raise DataError(
            "has no column for current",
            where=path,
            advice="Add a column current_A, or give --current 0.2A",
        )
    t = constant["temperature"] if file.temperature is None else file.temperature
    x = file.displacement - side * centre
    _refuse_contradiction(file, path)
    try:
        motion = time_motion(
            file.time, x, velocity=file.velocity, acceleration=file.acceleration,
            current=i, temperature=t, causal=causal,
        )  # fmt: skip
    except DataError as error:
        raise DataError(error.what, where=path, advice=error.advice) from error
    told = motion_outside(card.validity, motion, assumed)
    return Case(file.time, motion, told, (*file.notes, *_remarks(motion, file.time, side)))


def _need_finite(force: "np.ndarray", motion: Path | None, time: "np.ndarray") -> None:
    """Refuse a motion on which a card, whose own check vectors come out, has no force."""
    import numpy as np

    bad = np.flatnonzero(~np.isfinite(force))
    if bad.size:
        raise DataError(
            f"the damper has no finite force on this motion (at {bad.size} of {force.size} points, "
            f"the first at {time[bad[0]]:.4g} s)",
            where="--amplitude and --frequency" if motion is None else motion,
            advice="Look at the motion's units and size; nothing was written",
        )


def _refuse_contradiction(file: "MotionFile", path: Path) -> None:
    """Refuse a velocity or acceleration that contradicts the motion: another unit or sign."""
    from sysid.motion.derivatives import smooth_derivatives
    from sysid.motion.time_motion import FEWEST_SAMPLES

    t, x, v, a = file.time, file.displacement, file.velocity, file.acceleration
    if t.size < FEWEST_SAMPLES:
        return
    if v is not None:
        _hold("velocity", v, smooth_derivatives(t, x)[1], "rate of the displacement", path)
    if a is not None and v is None:
        of = "displacement's second derivative"
        _hold("acceleration", a, smooth_derivatives(t, x)[2], of, path)
    elif a is not None and v is not None:
        _hold("acceleration", a, smooth_derivatives(t, v)[1], "velocity's rate", path)


def _hold(column: str, given: "np.ndarray", rate: "np.ndarray", of: str, path: Path) -> None:
    share = _share(given, rate)
    if share is not None and not RATE[0] < share < RATE[1]:
        raise DataError(
            f"the column of {column} is {share:.3g} times the {of}",
            where=path,
            advice="Look at its unit and sign, or leave the column out",
        )


def _share(given: "np.ndarray", rate: "np.ndarray") -> float | None:
    """A column over what it would be without it; None where noise hides that.

    With noise in both, g·r/r·r is too near to zero and g·g/g·r too far from it, so that a column g
    contradicts r where both do: the one of them that is nearer to 1 is told.
    """
    product, power, own = float(given @ rate), float(rate @ rate), float(given @ given)
    if abs(product) <= ALIKE * (power * own) ** 0.5:
        return None
    return sorted((1.0, product / power, own / product))[1]


def _remarks(motion: "Motion", time: "np.ndarray", side: float) -> tuple[str, ...]:
    """What Eq. 10 makes of a displacement that is not about its centre, told in the file's sign."""
    import numpy as np

    from sysid.motion.time_motion import clipped_share

    told = []
    x = np.asarray(motion.displacement)
    mean = float(np.trapezoid(x, time) / (time[-1] - time[0]))
    if abs(mean) > 0.05 * float(np.abs(x - mean).max()):
        told.append(
            f"the displacement has a mean of {1e3 * side * mean:.3g} mm; the peak velocity (W11 "
            "Eq. 10) needs it relative to the centre, 1 mm of error costs tens of newtons; see "
            "--centre"
        )
    share = clipped_share(motion)
    if share > 0.0:
        told.append(
            f"W11 Eq. 10 has no real peak velocity at {share:.1%} of the points; 0 is taken there"
        )
    return tuple(told)


def force_csv(time: "np.ndarray", motion: "Motion", force: "np.ndarray") -> str:
    """The table of a simulation; numbers with every digit, nan where no temperature is known.

    Args:
        time: [n] s.
        motion: Of n points.
        force: [n] N.
    """
    import numpy as np

    columns = [
        time,
        motion.displacement,
        motion.velocity,
        motion.current,
        motion.temperature,
        force,
    ]
    rows = np.stack([np.broadcast_to(np.asarray(c), force.shape) for c in columns], axis=1)
    header = "time_s,displacement_m,velocity_m/s,current_A,temperature_degC,force_N"
    lines = (",".join(map(repr, row)) for row in rows.tolist())
    return "\n".join((header, *lines)) + "\n"
