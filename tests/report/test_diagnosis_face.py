"""diagnosis.json is the contract's, and the figures show the numbers that they were given."""

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import sysid.report
from sysid.cards.write import json_text
from sysid.diagnosis.words import EFFECT_WORDS
from sysid.report.before_after_plot import before_after_png, errors, plot_before_after
from sysid.report.diagnosis_json import diagnosis_json
from sysid.report.diagnosis_schema import json_schema
from sysid.report.gain_plot import arrange, gain_png, plot_gain
from sysid.report.lack_of_fit_maps import lack_of_fit_png
from sysid.report.page.headline import diagnosis_headline
from sysid.report.screen_plot import plot_screen, screen_png
from tests.report.made_diagnosis import backlash, inadequate, made, nothing, unknown

PUBLISHED = Path(sysid.report.__file__).with_name("diagnosis-1.schema.json")
CONTRACT = {
    "schema": (), "answer": (), "causes": (
        "id", "status", "class", "family", "parameters", "confidence", "because",
        "separating_test",
    ),
    "invisible": ("id", "because", "test"),
    "unknown": ("present", "parity", "depends_on", "exponents", "share_of_reducible"),
    "gain": (
        "held_out_nrmse_before", "held_out_nrmse_after", "noise_floor_nrmse",
        "reducible_explained", "low", "high", "held_out",
    ),
    "screen": ("id", "score", "threshold", "survival", "expected_change", "se"),
    "base": ("model", "held_out_nrmse", "rivals"),
}  # fmt: skip


def test_all_keys_of_the_contract_are_there():
    written = diagnosis_json(backlash())
    for key, inner in CONTRACT.items():
        value = written[key]
        first = value[0] if isinstance(value, list) else value
        assert set(inner) <= set(first if inner else ())
    assert written["schema"] == "sysid-diagnosis-1"
    assert written["causes"][0]["class"] == ["backlash"]
    delta = written["causes"][0]["parameters"]["delta"]
    assert {k: delta[k] for k in ("value", "unit", "low", "high", "level")} == {
        "value": 4.1e-4, "unit": "m", "low": pytest.approx(3.9e-4), "high": pytest.approx(4.3e-4),
        "level": 0.95,
    }  # fmt: skip
    assert [r["model"] for r in written["base"]["rivals"]] == ["bouc_wen"]


@pytest.mark.parametrize("answer", [backlash, nothing, unknown, inadequate])
def test_it_keeps_the_published_schema_and_is_the_same_each_time(answer):
    d = answer()
    text = json_text(diagnosis_json(d))  # refuses NaN
    jsonschema.validate(json.loads(text), json.loads(PUBLISHED.read_text(encoding="utf-8")))
    assert json_text(diagnosis_json(d)) == text
    assert (json.loads(text)["gain"] is None) == (d.gain is None)


def test_the_published_schema_is_that_of_the_classes():
    assert json.loads(PUBLISHED.read_text(encoding="utf-8")) == json_schema()


def test_unknown_numbers_are_null():
    written = diagnosis_json(
        unknown(), holdout=[("a", 0.2, float("nan"))], left_out={"b": "clipped"},
        free_run=(0.1, float("inf")),
    )  # fmt: skip
    assert written["unknown"]["exponents"]["frequency"] is None
    assert written["screen"][-1]["se"] is None
    assert written["base"]["rivals"][0]["extended_nrmse"] is None
    assert written["holdout"] == [{"id": "a", "nrmse_before": 0.2, "nrmse_after": None}]
    assert written["left_out"] == {"b": "clipped"}
    assert written["free_run"] == {"mean_nrmse": 0.1, "largest_deviation": None}


def test_the_page_tells_no_interval_beyond_all_of_the_error():
    gain = replace(backlash().gain, low=0.18, high=1.4)
    told = diagnosis_headline(diagnosis_json(made(gain=gain)), ()).gain
    assert told.endswith("95 % of what could be explained (95 % interval: at least 18 %).")


def test_sentences_of_the_diagnosis_come_first():
    assert diagnosis_json(made(sentences=("As I said.",)))["sentences"] == ["As I said."]
    assert "lost motion" in diagnosis_json(backlash())["sentences"][0]


def test_before_and_after_beside_measured():
    d = backlash()
    for over, x in (("velocity", d.loops.velocity), ("displacement", 1e3 * d.loops.displacement)):
        ax = plot_before_after(d, 3, over)
        lines = {str(line.get_label()): line for line in ax.lines}
        for label, force in (
            ("measured", d.loops.force),
            ("base model", d.simulated_before),
            ("extended model", d.simulated_after),
        ):
            np.testing.assert_array_equal(
                lines[label].get_ydata(), np.append(force[3], force[3, 0])
            )
            np.testing.assert_array_equal(lines[label].get_xdata(), np.append(x[3], x[3, 0]))
        assert ax.get_ylabel() == "force / N"
        assert ("m/s" if over == "velocity" else "mm") in ax.get_xlabel()
    assert [line.get_label() for line in plot_before_after(nothing(), 0).lines] == [
        "measured", "base model",
    ]  # fmt: skip


def test_loops_without_what_their_cycles_showed_say_so():
    d = backlash()
    taken = replace(d, causes=(replace(d.causes[0], from_cycles=True),))
    label = plot_before_after(taken, 0).lines[0].get_label()
    assert label == f"measured, less {EFFECT_WORDS['backlash']}"


def test_gain_rows_are_conditions_worst_first_and_panels_are_currents():
    d = backlash()
    assert d.gain is not None
    order = np.random.default_rng(0).permutation(len(d.loops.ids))
    shuffled = replace(
        d.gain,
        held_out=tuple(d.gain.held_out[k] for k in order),
        per_test_before=d.gain.per_test_before[order],
        per_test_after=d.gain.per_test_after[order],
    )
    names, panels = arrange(d.loops, shuffled)
    assert list(panels) == ["0 A", "0.2 A", "0.4 A"]
    assert len(names) == 6
    before = errors(d, d.simulated_before)
    means = {
        n: before[[f"{1e3 * a:.3g} mm, {f:.2g} Hz" == n for a, f in zip(
            d.loops.amplitude, d.loops.frequency, strict=True)]].mean()
        for n in names
    }  # fmt: skip
    assert sorted(means.values(), reverse=True) == list(means.values())
    panel = panels["0.2 A"]
    k = d.loops.ids.index("25mm_0.5Hz_0.2A")
    row = list(panel.rows).index(names.index("25 mm, 0.5 Hz"))
    assert panel.before[row] == pytest.approx(100 * before[k])
    assert panel.floor[row] == pytest.approx(100 * 2.0 / np.abs(d.loops.force[k]).max())
    ax = plot_gain((names, panel))
    assert [t.get_text() for t in ax.get_yticklabels()] == names
    bottom, top = ax.get_ylim()
    assert bottom > top  # the first row, the worst condition, is on top


def test_measured_conditions_that_scatter_share_a_row_and_nothing_is_cut_off():
    d = backlash()
    assert d.gain is not None
    rng = np.random.default_rng(3)
    count = len(d.loops.ids)
    loops = replace(
        d.loops,
        amplitude=d.loops.amplitude * rng.normal(1.0, 4e-3, count),
        frequency=d.loops.frequency * rng.normal(1.0, 5e-4, count),
        current=d.loops.current + rng.normal(0.0, 6e-3, count),
    )
    names, panels = arrange(loops, d.gain)
    assert len(names) == 6
    assert len(panels) == 3  # the page and the maps know no other levels
    for errors_ in panels.values():
        assert sorted(errors_.rows) == list(range(6))
        assert plot_gain((names, errors_)).get_xlim()[1] > errors_.before.max()


def test_screen_shows_thresholds_and_greys_what_cannot_be_seen():
    d = backlash()
    ax = plot_screen((d.screen, ["backlash"]))
    assert ax.get_xscale() == "log"
    labels = {t.get_text(): t for t in ax.get_yticklabels()}
    assert next(iter(labels)).startswith("backlash")
    hidden = [r.id for r in d.screen if r.survival < 0.002]
    assert hidden
    for name in hidden:
        assert labels[name].get_color() == "0.6"
    assert sum(t.get_text() == "these tests cannot show it" for t in ax.texts) == len(hidden)
    marks = [line.get_xdata() for line in ax.lines if line.get_marker() == "|"]
    thresholds = [float(np.ravel(x)[0]) for x in marks if len(np.ravel(x)) == 1]
    assert thresholds == [13.6] * (len(d.screen) - len(hidden))


def test_files_are_pictures_and_the_same_each_time():
    d = backlash()
    for draw in (before_after_png, gain_png, screen_png, lack_of_fit_png):
        first = draw(d)
        assert first is not None
        assert first.startswith(b"\x89PNG")
        assert draw(d) == first
    assert gain_png(nothing()) is None
    assert lack_of_fit_png(nothing()).startswith(b"\x89PNG")


def test_far_from_any_model_scores_are_not_held_against_chance():
    d = backlash()
    rows = tuple(replace(r, threshold=np.nan, se=np.nan) for r in d.screen)
    ax = plot_screen((rows, ()))
    marks = [line for line in ax.lines if line.get_marker() == "|"]
    assert not any(np.isfinite(np.asarray(line.get_xdata(), dtype=float)).any() for line in marks)
    legend = ax.get_legend()
    assert legend is not None
    (told,) = (t.get_text() for t in legend.get_texts())
    assert told == "no model is near: not held against chance"
    assert "χ²" not in ax.get_xlabel()
