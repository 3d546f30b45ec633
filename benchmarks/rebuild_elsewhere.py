"""Would another processor rebuild the physical datasets byte for byte?

``python benchmarks/rebuild_elsewhere.py`` rebuilds every eighth test (``--every N``) with the
instructions of older processors, without fused multiply-add and with shorter vectors, and counts
what comes out otherwise.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Final

import numpy as np
from outcome import Outcome

DATASETS: Final = Path(__file__).resolve().parent.parent / "datasets"
ISAS: Final = ("AVX512", "AVX2", "SSE4_2")
"""Largest instruction set that XLA may use; with AVX2 and less numpy uses its baseline."""
SHIFTS: Final = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)
"""N by which all forces are shifted, to see how near values lie to the edge between two digits."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=8, help="1 for all tests")
    parser.add_argument("--into", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.into:
        _rebuild(given.into, given.every)
        return
    page = Outcome("rebuild_elsewhere", "Physical datasets rebuilt on other processors")
    page.say(
        f"Every {given.every}th test of both datasets. Forces of a differential equation come out "
        "a little otherwise where a processor rounds otherwise. Each row rebuilds with one "
        "instruction set as the largest; differences are those from the first row, in newtons on "
        "the load cell, and from the shipped files."
    )
    with tempfile.TemporaryDirectory() as scratch:
        found = {isa: _elsewhere(isa, Path(scratch) / isa, given.every) for isa in ISAS}
    rows, numbers = [], []
    for isa, results in found.items():
        for name, (force, files, values, _) in results.items():
            away = float(np.max(np.abs(force - found[ISAS[0]][name][0])))
            rows.append([isa, name, f"{away:.1e} N", f"{values} values", files])
            numbers.append(
                {"isa": isa, "dataset": name, "force_N": away, "files": files, "values": values}
            )
    page.table(
        ["instructions", "dataset", "largest difference of a force", "of", "files that differ"],
        rows,
    )
    page.say(
        "How much otherwise would be too much: all forces shifted by so much, up and down, change "
        "this many values in the files."
    )
    margins = {
        name: dict(zip(SHIFTS, r[3].tolist(), strict=True)) for name, r in found[ISAS[0]].items()
    }
    page.table(
        ["dataset", *(f"{shift:g} N" for shift in SHIFTS)],
        [[name, *map(str, m.values())] for name, m in margins.items()],
    )
    page.numbers = {"every": given.every, "rebuilt": numbers, "margins": margins}
    page.finish()


def _elsewhere(isa: str, into: Path, every: int) -> dict[str, tuple]:
    """Dataset → forces, files that differ, values in them, values changed by each shift."""
    dispatched = import_module("numpy._core._multiarray_umath").__cpu_dispatch__
    limits = {
        "XLA_FLAGS": f"--xla_cpu_max_isa={isa}",
        "JAX_ENABLE_COMPILATION_CACHE": "false",
        "NPY_DISABLE_CPU_FEATURES": "" if isa == ISAS[0] else " ".join(dispatched),
    }
    words = [sys.executable, "-W", "ignore", __file__, "--into", str(into)]
    subprocess.run([*words, "--every", str(every)], env=os.environ | limits, check=True)
    results = {}
    for file in sorted(into.iterdir()):
        with np.load(file) as z:
            results[file.stem] = (z["force"], int(z["files"]), int(z["values"]), z["changed"])
    return results


def _rebuild(into: Path, every: int) -> None:
    from sysid.rig.physical.campaign import recorded, run_campaign
    from sysid.rig.physical.files import files_of
    from sysid.rig.scenarios.physical import PHYSICAL

    into.mkdir()
    for campaign in PHYSICAL:
        done = run_campaign(campaign, campaign.seed, range(0, len(campaign.settings), every))
        made = files_of(campaign, campaign.seed, done)
        names = [f"{campaign.settings[k].name}.csv" for k in done.tests]
        folder = DATASETS / campaign.dataset
        files = sum((folder / name).read_bytes() != made[name] for name in names)
        changed = []
        for shift in SHIFTS:
            count = 0
            for by in (shift, -shift):
                moved = replace(done.courses, force=done.courses.force + by)
                again = recorded(campaign, done.prepared, campaign.seed, done.tests, moved)
                count += sum(
                    int(np.count_nonzero(a.force != b.force))
                    for a, b in zip(again, done.recordings, strict=True)
                )
            changed.append(count)
        np.savez(
            into / f"{campaign.dataset}.npz", force=done.courses.force, files=files,
            values=sum(r.force.size for r in done.recordings), changed=changed,
        )  # fmt: skip


if __name__ == "__main__":
    main()
