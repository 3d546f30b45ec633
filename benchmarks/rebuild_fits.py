"""Rebuild `fits/`: ``python benchmarks/rebuild_fits.py``.

Runs `sysid fit` on every shipped dataset, in the variant that its table has.
"""

import shutil
import sys
import tempfile
from pathlib import Path

from sysid.cli.app import run

ROOT = Path(__file__).resolve().parent.parent
VARIANTS = {
    "virtual-w11-low": "symmetric",
    "virtual-w11-high": "symmetric",
    "virtual-w11-asymmetric": "asymmetric",
}


def rebuild(dataset: str, folder: Path) -> None:
    """Fit one dataset; keep card.json and fit.json."""
    with tempfile.TemporaryDirectory() as scratch:
        code = run(
            ["fit", str(ROOT / "datasets" / dataset), "--variant", VARIANTS[dataset],
             "-o", scratch, "--no-posterior", "--quiet"]
        )  # fmt: skip
        if code:
            raise SystemExit(code)
        folder.mkdir(parents=True, exist_ok=True)
        for name in ("card.json", "fit.json"):
            shutil.copyfile(Path(scratch) / name, folder / name)


def main() -> int:
    """Rebuild all."""
    for dataset in VARIANTS:
        rebuild(dataset, ROOT / "fits" / dataset)
        print(f"fits/{dataset}: card.json, fit.json")
    return 0


if __name__ == "__main__":
    sys.exit(main())
