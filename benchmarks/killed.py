"""`sysid fit` killed at ten random moments: is anything lost, and is the end the same."""

import argparse
import hashlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

import numpy as np
from outcome import Outcome

DATA: Final = Path(__file__).parents[1] / "datasets" / "virtual-w11-low"
COMMAND: Final = (
    sys.executable, "-m", "sysid.cli.app", "fit", str(DATA), "--variant", "passive",
    "--exclude", "*0.1A", "--exclude", "*0.2A", "--exclude", "*0.3A", "--exclude", "*0.4A",
    "--posterior-budget", "30min", "--quiet", "-o",
)  # fmt: skip
KILLS: Final = 10
BEFORE: Final = 3
"""Of them before the first block is stored, the sooner ones before anything is."""
SEED: Final = 20
PATIENCE: Final = 300.0


def blocks(folder: Path) -> dict[str, str]:
    """What is stored: name of each file → hash."""
    parts = folder / "posterior.parts"
    found = sorted(parts.glob("*.h5")) if parts.is_dir() else []
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in found}


def started_in(folder: Path) -> subprocess.Popen[bytes]:
    """The fit, running."""
    quiet = subprocess.DEVNULL
    return subprocess.Popen([*COMMAND, str(folder)], stdout=quiet, stderr=quiet)


def left_in_peace(folder: Path) -> tuple[float, int, float]:
    """One run to its end: seconds, blocks seen, seconds of a block."""
    started, seen = time.monotonic(), {}
    child = started_in(folder)
    while child.poll() is None:
        for path in (folder / "posterior.parts").glob("0*.h5"):
            seen.setdefault(path.name, time.monotonic())
        time.sleep(0.002)
    if child.returncode:
        raise SystemExit(f"the fit ended with {child.returncode}")
    moments = sorted(seen.values())
    pace = float(np.mean(np.diff(moments))) if len(moments) > 1 else 1.0
    return time.monotonic() - started, len(moments), pace


def kill_at(folder: Path, wanted: int, wait: float) -> bool:
    """Start, wait for a number of stored blocks and a little more, kill; False if it had ended."""
    child = started_in(folder)
    until = time.monotonic() + PATIENCE
    while len([n for n in blocks_named(folder) if n[0] == "0"]) < wanted:
        if child.poll() is not None or time.monotonic() > until:
            break
        time.sleep(0.002)
    time.sleep(wait)
    if child.poll() is not None:
        return False
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    return True


def blocks_named(folder: Path) -> list[str]:
    """Names alone."""
    parts = folder / "posterior.parts"
    return [p.name for p in parts.glob("*.h5")] if parts.is_dir() else []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="three kills, nothing written")
    quick = parser.parse_args().quick
    kills = 3 if quick else KILLS
    rng = np.random.default_rng(SEED)
    with tempfile.TemporaryDirectory() as name:
        peace, folder = Path(name) / "peace", Path(name) / "killed"
        took, count, pace = left_in_peace(peace)
        if count < kills - BEFORE + 1:
            raise SystemExit(f"{count} blocks are too few for {kills} kills")
        early = np.sort(rng.uniform(0.0, 0.6 * took, BEFORE))
        after = np.sort(rng.choice(np.arange(1, count), kills - BEFORE, replace=False))
        moments = [(0, t) for t in early] + [(int(k), rng.uniform(0.0, pace)) for k in after]
        rows, lost, stored = [], 0, {}
        for wanted, wait in moments:
            killed = kill_at(folder, wanted, wait)
            now = blocks(folder)
            lost += sum(now.get(file) != digest for file, digest in stored.items())
            when = f"{wait:.2f} s after {f'block {wanted}' if wanted else 'its start'}"
            rows.append((when, "yes" if killed else "it had ended", len(stored), len(now)))
            print(rows[-1], flush=True)
            stored = now
        left_in_peace(folder)
        same = {
            file: (peace / file).read_bytes() == (folder / file).read_bytes()
            for file in ("posterior.h5", "card.json", "fit.json")
        }
    outcome = Outcome("killed", "A posterior that is killed again and again")
    outcome.say(
        "`sysid fit` of the 0 A tests of `virtual-w11-low`, killed with SIGKILL and started again",
        f"by the same command; left in peace it takes {took:.0f} s and {count} blocks of 50 steps.",
    )
    outcome.table(("killed", "killed in fact", "files stored before", "after"), rows)
    outcome.say(
        f"Stored files that were lost or changed by a kill: {lost}.  At the end, byte by byte as",
        "if it had been left in peace: "
        + ", ".join(f"{file} {'yes' if equal else 'NO'}" for file, equal in same.items())
        + ".",
    )
    outcome.numbers = {"kills": len(rows), "lost": lost, "same": same, "blocks": count}
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
