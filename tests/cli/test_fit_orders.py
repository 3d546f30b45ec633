"""What `sysid fit` is asked for, and how it ends: orders, ranges, exit codes, full disks."""

import errno
import os
from pathlib import Path

import pytest

from sysid.cli import identify as pipeline
from sysid.cli.app import run
from sysid.cli.options import VARIANTS, Model
from sysid.errors import FitError
from sysid.identification.result import Result
from tests.cli.shipped import LOW, some_tests

FILES = {"card.json", "fit.json", "loops.png", "report.html", "worst.png"}
HELD = "12.5mm_2.5Hz_*"


class Asked:
    """Stands in for `identify` and remembers what it was asked for."""

    def __init__(self, real):
        self.real, self.calls = real, []

    def __call__(self, campaign, selection, **options):
        self.calls.append((campaign, selection, options))
        suffix = options["suffix"]
        files = {f"fit{suffix}.json": b"{}", f"card{suffix}.json": b"{}"}
        return pipeline.Identified(None, None, None, {"n": len(self.calls)}, files, ())  # type: ignore[arg-type]  # not read by the command


@pytest.fixture
def asked(monkeypatch) -> Asked:
    fake = Asked(pipeline.identify)
    monkeypatch.setattr(pipeline, "identify", fake)
    monkeypatch.setattr("sysid.cli.tables.show_fit", lambda *args: None)
    return fake


@pytest.mark.parametrize("model", Model)
def test_every_model_is_asked_for_by_name_with_its_default_variant(model, asked, sysid, tmp_path):
    assert sysid("fit", LOW, "-o", tmp_path / "out", "--model", model).code == 0
    ((_, _, options),) = asked.calls
    assert (options["model"], options["variant"]) == (model.value, VARIANTS[model][0])


@pytest.mark.parametrize(
    ("order", "message"),
    [
        (["--model", "dahl", "--variant", "mean"], "the dahl model has no variant 'mean'; it has"),
        (
            ["--variant", "full"],
            "has no variant 'full'; it has: asymmetric, symmetric, pass",
        ),
        (["--model", "maxwell"], "'maxwell' is not one of 'generalized', 'tanh', 'dahl', 'bouc_we"),
    ],
)
def test_wrong_model_or_variant_is_wrong_usage(order, message, asked, sysid, tmp_path):
    said = sysid("fit", LOW, "-o", tmp_path / "out", *order)
    assert said.code == 2
    assert message in " ".join(said.err.replace("│", " ").split())
    assert asked.calls == []
    assert not (tmp_path / "out").exists()


def test_several_ranges_give_one_card_each(asked, sysid, tmp_path):
    order = ["--frequency-range", "0.5", "1.5", "--frequency-range", "2Hz", "5Hz"]
    said = sysid("fit", LOW, "-o", tmp_path / "out", *order, "--json", "--weights", "peak")
    assert said.code == 0
    assert set(said.json["fits"]) == {"fit-1.json", "fit-2.json"}
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "card-1.json", "fit-1.json", "card-2.json", "fit-2.json",
    }  # fmt: skip
    (_, first, options), (_, second, _) = asked.calls
    assert options["weights"] == "peak"
    assert "0.5–1.5 Hz" in options["remarks"][0]
    assert {name.split("_")[1] for name in first.loops.ids} == {"0.5Hz", "1.5Hz"}
    assert {name.split("_")[1] for name in second.loops.ids} == {"2.5Hz", "5Hz"}
    assert "not in the range of this model" in second.left_out["12.5mm_0.5Hz_0A"]


def test_one_range_keeps_the_plain_names(asked, sysid, tmp_path):
    order = ["--amplitude-range", "10", "15", "--exclude", "*_0A", "--exclude", "*_5Hz_*"]
    said = sysid("fit", LOW, "-o", tmp_path / "out", *order)
    assert said.code == 0
    assert (tmp_path / "out" / "card.json").exists()
    ((_, selection, _),) = asked.calls
    assert len(selection.loops.ids) == 12
    assert selection.left_out["12.5mm_5Hz_0A"] == "excluded by --exclude"
    assert "Note" not in sysid("fit", LOW, "-o", tmp_path / "out", *order, "-q").err


def test_a_range_without_tests_and_a_glob_without_match(asked, sysid, tmp_path):
    out = tmp_path / "out"
    said = sysid("fit", LOW, "-o", out, "--frequency-range", "7", "9")
    assert (said.code, "no test is left to fit (7–9 Hz)" in said.err) == (1, True)
    assert "give other ranges" in said.err
    for option, words in (("--holdout", "holds out all 20 tests"), ("--exclude", "exclude fewer")):
        said = sysid("fit", LOW, "-o", out, option, "*")
        assert (said.code, words in said.err, "sysid check" in said.err) == (1, True, False)
    said = sysid("fit", LOW, "-o", out, "--holdout", "nothing*")
    assert (said.code, "'nothing*' matches none of the 20 tests" in said.err) == (1, True)
    said = sysid("fit", LOW, "-o", out, "--exclude", "*")
    assert said.code == 1
    assert not out.exists()


def test_each_sub_folder_gets_its_own_fit(asked, sysid, tmp_path):
    for name, frequency in (("cold", "0.5"), ("warm", "1.5")):
        some_tests(tmp_path / "all" / name, [f"12.5mm_{frequency}Hz_{i}A" for i in ("0", "0.4")])
    order = ["--each", "--workers", "1", "-o", tmp_path / "out", "--json"]
    said = sysid("fit", tmp_path / "all", *order)
    assert said.code == 0
    assert set(said.json["fits"]) == {"cold/fit.json", "warm/fit.json"}
    assert (tmp_path / "out" / "warm" / "card.json").exists()
    assert [campaign.name for campaign, _, _ in asked.calls] == ["cold", "warm"]
    said = sysid("fit", tmp_path / "all" / "cold", "--each", "-o", tmp_path / "out2")
    assert (said.code, "has no sub-folders" in said.err) == (1, True)


def test_force_that_opposes_velocity_needs_flip_force(asked, sysid, tmp_path):
    some_tests(tmp_path / "c", ["12.5mm_1.5Hz_0A", "12.5mm_1.5Hz_0.4A"], sign=-1.0)
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out")
    assert said.code == 1
    assert "is left out: wrong_sign" in said.err
    assert sysid("check", tmp_path / "c").code == 3
    assert sysid("fit", tmp_path / "c", "-o", tmp_path / "out", "--flip-force").code == 0
    assert min(asked.calls[0][1].loops.force.max(axis=1)) > 0


def test_what_is_wrong_with_tests_that_are_used_is_told(asked, sysid, tmp_path):
    """A stroke that is not the label's spoils nothing, and whoever reads the fit must know."""
    stems = ["12.5mm_1.5Hz_0A", "12.5mm_1.5Hz_0.2A", "12.5mm_1.5Hz_0.4A"]
    some_tests(tmp_path / "c", stems)
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out")
    assert (said.code, "that are used" in said.err, "which is used" in said.err) == (
        0,
        False,
        False,
    )
    for stem in stems[:2]:
        (tmp_path / "c" / f"{stem}.csv").rename(
            tmp_path / "c" / f"{stem.replace('12.5', '20')}.csv"
        )
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out2")
    assert said.code == 0
    (told,) = [z for z in said.err.splitlines() if "that are used" in z]
    assert told.startswith(
        "Warning: amplitude_mislabelled in 2 of 3 tests that are used, such as 20mm"
    )
    assert "the measured amplitude is 12.5 mm" in told
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out3", "--exclude", "20mm_1.5Hz_0A")
    one = "Warning: amplitude_mislabelled in 20mm_1.5Hz_0.2A, which is used: the measured"
    assert one in said.err
    quiet = sysid("fit", tmp_path / "c", "-o", tmp_path / "out5", "--quiet")
    assert told in quiet.err.splitlines(), "a warning is no note"
    assert asked.calls[-1][1].doubts[0] in told
    excluded = ["--exclude", "20mm*"]
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out4", *excluded)
    assert "mislabelled" not in said.err


def test_a_fit_that_did_not_converge_is_exit_3_with_its_reason():
    class Unfinished:
        result, mean_nrmse = Result.unfinished, 0.01

    class Hopeless:
        result, mean_nrmse = Result.converged, 0.4

    class Sound:
        result, mean_nrmse = Result.converged, 0.1

    assert pipeline.distrust(Unfinished()) == (Result.unfinished.value,)  # type: ignore[arg-type]
    assert "40% of max|F|" in pipeline.distrust(Hopeless())[0]  # type: ignore[arg-type]
    assert pipeline.distrust(Sound()) == ()  # type: ignore[arg-type]


def test_distrust_becomes_exit_3_and_the_files_are_written(asked, sysid, tmp_path, monkeypatch):
    def doubtful(campaign, selection, **options):
        result = asked(campaign, selection, **options)
        return pipeline.Identified(None, None, None, {}, result.files, ("it ran out of steps",))  # type: ignore[arg-type]

    monkeypatch.setattr(pipeline, "identify", doubtful)
    said = sysid("fit", LOW, "-o", tmp_path / "out", "--json")
    assert said.code == 3
    assert "Do not trust this result: card.json: it ran out of steps" in said.err
    assert (tmp_path / "out" / "card.json").exists()


def test_a_full_disk_leaves_the_old_results(asked, sysid, tmp_path, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    (out / "card.json").write_text("old")
    (out / "mine.txt").write_text("mine")
    written = []

    def full(handle):
        written.append(handle)
        if len(written) == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    said = sysid("fit", LOW, "-o", out)
    monkeypatch.undo()
    assert said.code == 1
    assert "no space left on device" in said.err
    assert {p.name: p.read_text() for p in out.iterdir()} == {
        "card.json": "old",
        "mine.txt": "mine",
    }


def test_a_full_disk_leaves_no_new_folder(asked, sysid, tmp_path, monkeypatch):
    def full(handle):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    assert sysid("fit", LOW, "-o", tmp_path / "a" / "b").code == 1
    monkeypatch.undo()
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_may_not_be_written_is_refused_before_any_work(asked, sysid, tmp_path):
    (tmp_path / "file").write_text("")
    said = sysid("fit", LOW, "-o", tmp_path / "file" / "out")
    assert (said.code, "is a file, not a folder" in said.err) == (1, True)
    assert asked.calls == []


def test_no_permission(asked, sysid, tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda place, mode: Path(place) != tmp_path)
    said = sysid("fit", LOW, "-o", tmp_path / "out")
    assert (said.code, "may not be written to" in said.err) == (1, True)


def test_a_folder_that_is_not_there_is_all_that_is_told(sysid, tmp_path):
    """Nothing of what would have been done with it."""
    said = sysid("fit", tmp_path / "nowhere", "-o", tmp_path / "out", "--variant", "symmetric")
    assert said.code == 1
    assert "nowhere" in said.err
    assert "posterior" not in said.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [("--likelihood", "independent"), ("--posterior-budget", "5s")])
def test_how_to_draw_is_an_order_to_draw(option, asked, sysid, tmp_path):
    """Also of a model whose posterior is not drawn unasked; and not to draw contradicts it."""
    order = ("fit", LOW, "-o", tmp_path / "out", "--model", "dahl", *map(str, option))
    refused = sysid(*order, "--no-posterior")
    assert refused.code == 2
    assert f"{option[0]} say" in refused.err
    assert asked.calls == []
    assert run([str(z) for z in order]) == 0
    assert asked.calls[0][2]["draws"] is not None
    assert run([*map(str, order[:-2]), "--no-posterior"]) == 0
    assert asked.calls[1][2]["draws"] is None


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_what_is_excluded_need_not_be_readable(command, asked, sysid, tmp_path, monkeypatch):
    folder = tmp_path / "tests"
    some_tests(folder, ["12.5mm_0.5Hz_0A", "12.5mm_0.5Hz_0.4A"])
    (folder / "15mm_1Hz_0A.csv").write_text("nothing\n")
    monkeypatch.setattr("sysid.cli.diagnosed.diagnosed", _stopped)
    order = [command, folder, "-o", tmp_path / "out"]
    assert "has no header" in sysid(*order).err
    said = sysid(*order, "--exclude", "15mm*")
    assert "15mm_1Hz_0A.csv is excluded, and cannot be read: has no header" in said.err
    assert said.code == (0 if command == "fit" else 1)


def _stopped(*_args, **_options):
    raise FitError("stopped here", advice="Nothing")
