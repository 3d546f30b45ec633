"""Steady loops of the shipped datasets."""

from pathlib import Path

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.data.loops import Loops

DATASETS = Path(__file__).resolve().parents[2] / "datasets"


def shipped_loops(name: str) -> Loops:
    """Loops of a dataset, by its folder's name."""
    return cut_loops(load_campaign(DATASETS / name).records).loops
