"""Bands as pictures, in fit.json and in sentences."""

import dataclasses
import json

import numpy as np
import pytest

from sysid.report.bands_json import band_sentences, bands_json
from sysid.report.bands_plot import bands_png, plot_band, shown
from sysid.uncertainty.bands import Band
from sysid.uncertainty.conformal import Conformal
from sysid.uncertainty.loop_bands import LoopBands

LOOPS, POINTS = 20, 36
PHASE = 2.0 * np.pi * np.arange(POINTS) / POINTS


def band(middle: np.ndarray, half: float) -> Band:
    return Band(0.95, middle, middle - half * 100.0, middle + half * 100.0)


@pytest.fixture
def bands() -> LoopBands:
    """Loops of 100 N, twenty of one condition each; the last is stronger, and held out."""
    force = 100.0 * np.tile(np.cos(PHASE), (LOOPS, 1))
    force[-1] *= 2.0
    measured = force + 2.0
    measured[0] += 100.0
    held_out = np.arange(LOOPS) == LOOPS - 1
    return LoopBands(
        ids=tuple(f"test-{k}" for k in range(LOOPS)),
        held_out=held_out,
        velocity=np.tile(np.cos(PHASE), (LOOPS, 1)),
        measured=measured,
        forces={
            "parameters": band(force, 0.01), "laws": band(force, 0.015),
            "recorded": band(force, 0.03),
        },
        quantities=(band(force[:, 0], 0.02),) * 3,
        unknown={},
        outside=("",) * (LOOPS - 1) + ("speed",),
        conformal=Conformal(
            0.95, np.arange(LOOPS), np.full(LOOPS, 3.0), np.zeros((LOOPS, 2)), 1.0, 0.01, "said"
        ),
        conformal_band=band(force, 0.05),
        draws=10,
    )  # fmt: skip


def test_numbers_are_those_of_the_bands(bands):
    found = json.loads(json.dumps(bands_json(bands)))
    assert found["level"] == 0.95
    assert found["conformal"]["conditions"] == LOOPS
    assert found["conformal"]["score"] == 3.0
    first, last = found["tests"][0], found["tests"][-1]
    widths = {"parameters": 1.0, "laws": 1.5, "recorded": 3.0, "conformal": 5.0}
    assert first["mean_half_width_N"] == pytest.approx(widths)
    assert (first["inside_recorded"], first["whole_inside_conformal"]) == (0.0, False)
    assert (last["inside_recorded"], last["whole_inside_conformal"]) == (1.0, True)
    assert last["held_out"]
    assert last["extrapolated_in"] == "speed"
    assert last["peak_force_N"] == pytest.approx({"value": 200.0, "low": 198.0, "high": 202.0})


def test_sentences_say_how_wide_and_how_often(bands):
    told = band_sentences(bands)
    assert "± 0.98% by the parameters, ± 1.47% with errors of the laws" in told[0]
    assert told[0].endswith("for what a new test would record")
    assert told[1] == "Of the points of fitted tests 94.7% lie within the last"
    assert told[2] == "Of the points of held-out tests 100.0% lie within the last"
    assert "Outside of the ranges that were fitted lie 1 of 20 tests" in told[3]
    assert told[-1].startswith("Without any likelihood, from tests left out: ± 4.90%; said")


def test_what_is_not_known_is_said_and_has_no_number(bands):
    less = dataclasses.replace(
        bands,
        forces={k: b for k, b in bands.forces.items() if k != "laws"},
        unknown={"laws": "Nothing is known of them"},
        conformal_band=None,
        statics_free=True,
    )
    told = band_sentences(less)
    assert "Nothing is known of them" in told
    assert told[0].endswith("would record, with all that the model leaves taken for noise")
    assert "errors of the laws" not in " ".join(told)
    assert any("apart from a static force of each test" in z for z in told)
    assert told[-1] == "Said"
    found = bands_json(less)
    assert found["not_known"] == {"laws": "Nothing is known of them"}
    assert set(found["tests"][0]["mean_half_width_N"]) == {"parameters", "recorded"}
    assert found["tests"][0]["whole_inside_conformal"] is None
    assert bands_png(less, "without").startswith(b"\x89PNG")


def test_pictures_show_what_was_held_out_and_all_bands(bands):
    assert shown(bands)[0] == LOOPS - 1
    assert len(set(shown(bands))) == 6
    assert bands_png(bands, "bands").startswith(b"\x89PNG")
    ax = plot_band((bands, 3))
    assert len(ax.collections) == 2
    drawn = [np.asarray(line.get_ydata(), dtype=float) for line in ax.lines]
    ends = sorted({round(float(y[0]), 6) for y in drawn if y.size})
    assert ends == [-5.0, -1.0, 1.0, 2.0, 5.0]
    assert ax.lines[0].get_xdata()[-1] == 360.0
    told = ax.get_legend_handles_labels()[1]
    assert told == ["conformal, whole loop", "recorded", "laws", "parameters", "measured"]
