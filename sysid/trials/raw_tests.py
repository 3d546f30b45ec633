"""A trial campaign as files: raw tests as a rig would store them, and the sealed truth."""

from typing import Final

import numpy as np

from sysid.rig.trial_campaign import Trial
from sysid.rig.truth import SEAL_FILE, Truth, seal

_HEADER: Final = "time_s,displacement_mm,force_N,current_A,temperature_degC\n"
_MANIFEST: Final = """\
[campaign]
name = "{name}"
positive_force = "compression"
positive_displacement = "compression"

[limits]
stroke = {{ value = 150, unit = "mm" }}
velocity = {{ value = 0.4, unit = "m/s" }}
current = {{ value = 0.5, unit = "A" }}
"""


def raw_tests(trial: Trial, name: str, seed: int) -> dict[str, bytes]:
    """Every cycle of every test, a file each, with manifest, table of tests and sealed truth.

    Args:
        trial: The campaign; its loops keep the deviations of all cycles.
        name: Of the campaign.
        seed: That it was made with, for the seal.

    Returns:
        Path relative to the campaign's folder → content.
    """
    loops, truth = trial.loops, trial.truth
    files = {"campaign.toml": _MANIFEST.format(name=name).encode()}
    table = ["file,run_order\n"]
    for k, id in enumerate(loops.ids):
        files[f"{id}.csv"] = _test(trial, k)
        table.append(f"{id}.csv,{int(trial.run_order[k])}\n")
    files["tests.csv"] = "".join(table).encode()
    effects = tuple(
        {"planter": planter.name, "causes": list(planter.causes), "quantities": dict(quantities)}
        for planter, quantities in zip(truth.planters, truth.nominal, strict=True)
    )
    text, _ = seal(Truth(name, seed, "w11", dict(truth.parameters), effects, {}))
    files[SEAL_FILE] = text.encode()
    return files


def _test(trial: Trial, k: int) -> bytes:
    """All cycles of one test as the recorder stores them."""
    loops = trial.loops
    force = (loops.force[k] + loops.deviations[k]).ravel()
    place = loops.displacement[k] + loops.centre[k]
    x = (place + loops.displacement_deviations[k]).ravel()
    time = np.arange(force.size) / (loops.force.shape[1] * loops.frequency[k])
    current, warm = f"{loops.current[k]:.4g}", f"{loops.temperature[k]:.1f}"
    rows = (
        f"{t:.7f},{1e3 * z:.5f},{f:.2f},{current},{warm}"
        for t, z, f in zip(time.tolist(), x.tolist(), force.tolist(), strict=True)
    )
    return (_HEADER + "\n".join(rows) + "\n").encode()
