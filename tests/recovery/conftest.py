"""The benchmarks are scripts in a folder of their own; their fast slices are tests here."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
