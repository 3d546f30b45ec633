"""Rebuild every shipped virtual dataset in place: ``python benchmarks/rebuild_datasets.py``.

Git then shows no difference, on any machine.  ``--check`` writes nothing and fails on the first
difference.
"""

import sys
from pathlib import Path

from sysid.rig.campaign import make_campaign
from sysid.rig.folder import write_folder
from sysid.rig.scenarios import SCENARIOS
from sysid.rig.scenarios.physical import PHYSICAL

DATASETS = Path(__file__).resolve().parent.parent / "datasets"


def main() -> int:
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        print(__doc__, file=sys.stderr)
        return 2
    total = 0
    for scenario in (*SCENARIOS, *PHYSICAL):
        files = make_campaign(scenario)
        folder = DATASETS / getattr(scenario, "dataset", scenario.id)
        size = sum(len(content) for content in files.values())
        total += size
        if check:
            for name, content in files.items():
                if (folder / name).read_bytes() != content:
                    print(f"{folder / name} differs from what the rig makes", file=sys.stderr)
                    return 1
        else:
            write_folder(files, folder)
        print(f"{scenario.id}: {len(scenario.settings)} tests, {size / 1e6:.2f} MB")
    print(f"together {total / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
