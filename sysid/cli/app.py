"""Entry point: the commands, and the one place where errors become messages and exit codes.

Exit codes: 0 done, 1 the input is at fault, 2 wrong usage, 3 done but not to be trusted; 130 where
the user stopped it.
"""

import os
import shlex
import sys
import traceback
from collections.abc import Sequence
from io import TextIOWrapper
from typing import Annotated, Final

import typer

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from sysid import __version__
from sysid.cli.check import check
from sysid.cli.compare import compare
from sysid.cli.demo import demo
from sysid.cli.diagnose import diagnose
from sysid.cli.export import export
from sysid.cli.fit import fit
from sysid.cli.isolator import isolator
from sysid.cli.next import next_tests
from sysid.cli.options import join_ranges
from sysid.cli.rig import rig
from sysid.cli.simulate import simulate
from sysid.cli.trials import trials
from sysid.cli.validate import validate
from sysid.errors import Stopped, SysidError

START: Final = """\
sysid turns measured tests of a magnetorheological damper into an identified model.

  sysid demo                          the whole story on a virtual damper, in a minute
  sysid check CAMPAIGN                what is in a folder of tests, and is it sound?
  sysid fit CAMPAIGN -o DIR           identify the damper; DIR gets card.json, report.html, figures
  sysid diagnose CAMPAIGN -o DIR      what the model gets wrong, why, and what mending it is worth
  sysid next DIR                      which test would settle what the diagnosis left open?
  sysid simulate DIR/card.json --amplitude 12.5mm --frequency 1.5Hz --current 0.2A -o force.csv
  sysid validate DIR/card.json CAMPAIGN
  sysid compare CARD CARD --on CAMPAIGN
  sysid export DIR/card.json --to fmu -o damper.fmu   (or c, modelica, csv)
  sysid isolator DIR/card.json -o DIR what the damper does in a vibration isolator

A CAMPAIGN is a folder with one CSV file a test, columns like time_s, displacement_mm, force_N,
and conditions in the file name (12.5mm_1.5Hz_0.2A.csv) or in tests.csv.
More: sysid --help, sysid COMMAND --help
"""

STOPPED: Final = 130
"""Exit code where the user pressed Ctrl-C, as shells have it."""

app = typer.Typer(
    name="sysid",
    help="From measured tests of a magnetorheological damper to an identified model.",
    add_completion=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def start(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """From measured tests of a magnetorheological damper to an identified model."""
    if version:
        typer.echo(f"sysid {__version__}")
    elif context.invoked_subcommand is None:
        typer.echo(START, nl=False)


COMMANDS: Final = (
    check, fit, diagnose, simulate, validate, compare, export, isolator, rig, trials, demo,
)  # fmt: skip
for command in COMMANDS:
    app.command()(command)
app.command("next")(next_tests)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave with its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a sign that the terminal lacks stops nothing
            stream.reconfigure(errors="replace")
    sys.exit(run(sys.argv[1:] if arguments is None else arguments))


def run(arguments: Sequence[str]) -> int:
    """Run one command; every failure becomes one message on stderr and an exit code."""
    usage_error, click_error = typer.BadParameter.__mro__[1:3]
    try:
        command = typer.main.get_command(app)
        code = command.main(
            join_ranges(arguments), prog_name="sysid", standalone_mode=False,
            obj=shlex.join(("sysid", *arguments)),
        )  # fmt: skip
        sys.stdout.flush()
        if code == STOPPED:  # what typer makes of Ctrl-C, without a word
            raise KeyboardInterrupt
        return code if isinstance(code, int) else 0
    except (KeyboardInterrupt, typer.Abort):
        return _tell("Stopped before the end; no result was written.", STOPPED)
    except Stopped as stop:
        return _tell(str(stop), STOPPED)
    except BrokenPipeError:
        _discard_stdout()
        return 1
    except SysidError as error:
        return _tell(f"Error: {error}", 1)
    except MemoryError:
        return _tell("Error: not enough memory. Fit fewer tests, or shorter records.", 1)
    except Exception as error:
        if isinstance(error, click_error):
            wrong_usage = isinstance(error, usage_error)
            return _tell(_usage(error), 2 if wrong_usage else 1)
        if isinstance(error, OSError):
            return _tell(f"Error: {error.filename or 'a file'}: {error.strerror or error}.", 1)
        return _defect(error)


def _usage(error: Exception) -> str:
    """What is wrong with the command line, and where its help is."""
    context = getattr(error, "ctx", None)
    path = "sysid" if context is None else context.command_path
    message = error.format_message() if hasattr(error, "format_message") else str(error)  # type: ignore[attr-defined]  # click's, guarded
    return f"Usage error: {message}\nSee: {path} --help"


def _defect(error: Exception) -> int:
    """A fault of this program: one line, and the traceback only where it is asked for."""
    if os.environ.get("SYSID_TRACEBACK"):
        traceback.print_exception(error)
    said = " ".join(str(error).split())[:300]
    return _tell(
        f"Error: internal fault of sysid ({type(error).__name__}: {said}). No result was written. "
        "Please report it with the output of the same command with SYSID_TRACEBACK=1 set.",
        1,
    )


def _tell(message: str, code: int) -> int:
    try:
        print(message, file=sys.stderr)
    except BrokenPipeError:
        _discard_stdout()
    return code


def _discard_stdout() -> None:
    """Nobody reads on: keep Python from complaining when it closes stdout."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    main()
