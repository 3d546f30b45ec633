"""A physical campaign as files: raw data, manifest, table of tests, page, sealed truth."""

from dataclasses import asdict
from typing import Any

import equinox as eqx

from sysid.rig.manifest_text import manifest_text
from sysid.rig.physical.campaign import PhysicalCampaign, TestsRun, run_campaign
from sysid.rig.physical.mechanisms import MECHANISMS, at_levels
from sysid.rig.physical.page import physical_page
from sysid.rig.recording import csv_text
from sysid.rig.truth import SEAL_FILE, Truth, seal


def make_physical(campaign: PhysicalCampaign, seed: int | None = None) -> dict[str, bytes]:
    """Run all tests of a campaign.

    Args:
        campaign: What to run.
        seed: Of the random numbers; None for the campaign's own.

    Returns:
        Path relative to the campaign's folder → content.
    """
    key = campaign.seed if seed is None else seed
    return files_of(campaign, key, run_campaign(campaign, key))


def files_of(campaign: PhysicalCampaign, key: int, done: TestsRun) -> dict[str, bytes]:
    """The same of tests that were run; `tests.csv` lists those only.

    Args:
        campaign: What was run.
        key: Of the random numbers.
        done: Its tests.
    """
    files: dict[str, bytes] = {}
    rows = ["file,amplitude_mm,frequency_Hz,current_A,temperature_degC,run_order,kind\n"]
    tests: dict[str, dict[str, Any]] = {}
    for k, recording, true in zip(done.tests, done.recordings, done.truths, strict=True):
        setting = campaign.settings[k]
        stem = setting.name
        files[f"{stem}.csv"] = csv_text(recording)
        tests[stem] = true
        label = f"{setting.temperature:g}" if setting.labelled else ""
        rows.append(
            f"{stem}.csv,{1e3 * setting.amplitude:g},{setting.frequency:g},{setting.current:g},"
            f"{label},{done.prepared.positions[k]},sine\n"
        )
    truth = Truth(
        campaign.id, key, "physical damper", constants(campaign), _hidden(campaign), tests
    )
    sealed, digest = seal(truth)
    told = "_{temperature}C" if campaign.settings[0].labelled else ""
    name = f"{{amplitude}}mm_{{frequency}}Hz_{{current}}A{told}"
    texts = {
        "tests.csv": "".join(rows),
        "campaign.toml": manifest_text(campaign.title, name, campaign.limits),
        "README.md": physical_page(campaign, key, digest),
        SEAL_FILE: sealed,
    }
    return files | {name: text.encode("utf-8") for name, text in texts.items()}


def constants(campaign: PhysicalCampaign) -> dict[str, float]:
    """Every constant of the damper in its rig, part.constant → value, SI and °C."""
    damper = at_levels(campaign.damper, campaign.levels)
    told = {}
    for part in vars(damper):
        inside = getattr(damper, part)
        if isinstance(inside, eqx.Module):
            told |= {f"{part}.{name}": float(value) for name, value in vars(inside).items()}
    return told | {f"operator.{name}": value for name, value in asdict(campaign.operator).items()}


def _hidden(campaign: PhysicalCampaign) -> tuple[dict[str, Any], ...]:
    """Every mechanism with its level and the names that the catalogue has for it."""
    return tuple(
        {"id": m.name, "level": campaign.levels.get(m.name, 1.0), "causes": list(m.causes)}
        for m in MECHANISMS
    )
