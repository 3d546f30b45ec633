"""From nothing to a report: the wheel in a clean environment, and `sysid demo` with empty caches.

``python benchmarks/newcomer.py`` writes results/newcomer.{md,json}; it needs a package index.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from outcome import Outcome

REPOSITORY = Path(__file__).parents[1]


def timed(*command: str | Path, folder: Path, home: Path) -> float:
    """Seconds of a command that sees nothing of this environment."""
    names = ("PATH", "PIP_INDEX_URL", "PIP_CONFIG_FILE", "PIP_FIND_LINKS", "SYSTEMROOT")
    seen = {name: os.environ[name] for name in names if name in os.environ}
    begin = time.perf_counter()
    subprocess.run(
        [str(word) for word in command], cwd=folder, check=True, capture_output=True,
        env={**seen, "HOME": str(home)},
    )  # fmt: skip
    return time.perf_counter() - begin


def main() -> None:
    outcome = Outcome("newcomer", "From nothing to a report")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        python, sysid = (folder / "env" / "bin" / z for z in ("python", "sysid"))
        build = (sys.executable, "-m", "pip", "wheel", REPOSITORY, "--no-deps", "-w", folder)
        steps = {"build the wheel": timed(*build, folder=folder, home=folder)}
        (wheel,) = folder.glob("*.whl")
        steps["make an environment"] = timed(
            sys.executable, "-m", "venv", folder / "env", folder=folder, home=folder
        )
        pinned = REPOSITORY / "constraints.txt"
        install = (python, "-m", "pip", "install", "--constraint", pinned, wheel)
        steps["install it with all it needs"] = timed(*install, folder=folder, home=folder)
        steps["sysid demo, nothing compiled yet"] = timed(sysid, "demo", folder=folder, home=folder)
        report = folder / "sysid-demo" / "diagnosis" / "report.html"
        size = report.stat().st_size
    outcome.table(("step", "s"), [(step, f"{z:.0f}") for step, z in steps.items()])
    outcome.say(f"report.html: {size / 1e6:.1f} MB.  Wheel and package index are this machine's.")
    outcome.numbers = {"seconds": steps, "report_bytes": size}
    outcome.finish()


if __name__ == "__main__":
    main()
