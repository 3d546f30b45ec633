"""The C compiler of this machine, where there is one."""

import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

COMPILERS: Final = ("cc", "gcc", "clang")
OPTIONS: Final = ("-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic")
EMPTY: Final = """
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int main(void) { return 0; }
"""
"""What every C compiler builds that can build anything here."""
NO_COMPILER: Final = f"no C compiler found ({', '.join(COMPILERS)})"


def compiler() -> str | None:
    """The first compiler on the path."""
    return next((found for z in COMPILERS if (found := shutil.which(z))), None)


def shared_library(
    files: Mapping[str, str], name: str, suffix: str, *, visible: bool = False
) -> tuple[bytes | None, str | None]:
    """A library made of ``name.c``, or why there is none.

    Args:
        files: File name → text.
        name: Of the source and the library, without ending.
        suffix: Of the library.
        visible: Every public function is, not only those that the source marks.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = f"{name}{suffix}"
        seen = "default" if visible else "hidden"
        options = ("-fPIC", "-shared", f"-fvisibility={seen}", "-o", out, f"{name}.c", "-lm")
        why = _build(files, Path(folder), options)
        return (None, why) if why else ((Path(folder) / out).read_bytes(), None)


def tested(files: Mapping[str, str], name: str, source: str) -> tuple[bool | None, str]:
    """Build and run the test program of an exported card.

    Args:
        files: Header, source and test, from `c_program`, and what `source` needs besides.
        name: Of the source without ending.
        source: The file that is compiled with the test: `name.c`, or one that includes it.

    Returns:
        Whether all check vectors agree, None where this machine cannot tell: it has no compiler, or
        one that does not even build an empty program, or lets nothing be run where it was built;
        and what the program, the compiler or the machine said.
    """
    with tempfile.TemporaryDirectory() as folder:
        options = ("-o", "test", source, f"{name}_test.c", "-lm")
        why = _build(files, Path(folder), options)
        if why:
            stub = _build({"empty.c": EMPTY}, Path(folder), ("-o", "empty", "empty.c", "-lm"))
            return (None, f"not built: {stub}") if stub else (False, why)
        try:
            done = subprocess.run(
                [str(Path(folder) / "test")], capture_output=True, text=True, check=False
            )
        except OSError as cause:
            return None, f"built, but not run: {cause.strerror or cause} ({folder})"
        return done.returncode == 0, done.stdout.strip()


def _build(files: Mapping[str, str], folder: Path, options: Sequence[str]) -> str | None:
    """None where it worked, else the first line of what was said of an error."""
    found = compiler()
    if found is None:
        return NO_COMPILER
    for file, text in files.items():
        (folder / file).write_text(text, encoding="utf-8")
    command = [found, *OPTIONS, *options]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    except OSError as cause:
        return f"the C compiler {found} cannot be run: {cause.strerror or cause}"
    if done.returncode == 0:
        return None
    said = done.stderr.strip().splitlines() or ["it failed without a message"]
    return f"the C compiler says: {next((line for line in said if 'error' in line), said[0])}"
