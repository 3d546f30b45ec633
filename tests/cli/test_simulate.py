"""`sysid simulate` as a user runs it."""

import errno
import os

import numpy as np
import pytest

from sysid.cards.models import damper_of
from sysid.cards.write import write_card
from sysid.data.motion_file import _gaps_told
from sysid.effects.registry import effect_kind, make
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from tests.cards.example import card_with, example_card

HEADER = "time_s,displacement_m,velocity_m/s,current_A,temperature_degC,force_N"
SINE = ["--amplitude", "12.5mm", "--frequency", "1.5Hz", "--current", "0.2A"]


def table(path):
    assert path.read_text().splitlines()[0] == HEADER
    return np.loadtxt(path, delimiter=",", skiprows=1)


def loop():
    a, f, i = (np.array([z]) for z in (0.0125, 1.5, 0.2))
    return np.asarray(simulate(damper_of(example_card()), sine_motion(a, f, i)))[0]


def test_a_steady_sine_is_the_loop_of_the_model(sysid, card_file, tmp_path):
    out = tmp_path / "Kraft 力.csv"
    said = sysid("simulate", card_file, *SINE, "--temperature", "313.15K", "-o", out)
    assert said.code == 0
    assert "360 points" in said.out
    t, x, v, i, temperature, force = table(out).T
    np.testing.assert_allclose(force, loop(), rtol=1e-12)
    assert np.abs(force).max() == pytest.approx(980, abs=1)  # W11 Table 2, low set
    np.testing.assert_allclose(t, np.arange(360) / 360 / 1.5, rtol=1e-12)
    np.testing.assert_allclose(
        v, 2 * np.pi * 1.5 * 0.0125 * np.cos(2 * np.pi * 1.5 * t), atol=1e-12
    )
    assert (i == 0.2).all()
    assert temperature == pytest.approx(40.0)
    assert x.max() == pytest.approx(0.0125)


def test_effects_of_the_card_are_simulated(sysid, card_file, tmp_path):
    """A gas spring adds k x, on a sine and on a motion from a file."""
    stiff = tmp_path / "stiff.json"
    write_card(card_with(make(effect_kind("gas_spring"))), stiff)
    sine = tmp_path / "sine.csv"
    for given in (SINE, ["--input", sine]):
        forces = {}
        for name, card in (("bare", card_file), ("stiff", stiff)):
            out = tmp_path / f"{name}.csv"
            said = sysid("simulate", card, *given, "-o", out, "--json")
            assert (said.code, said.json["notes"]) == (0, [])
            forces[name] = table(out)[:, 5]
        x = table(tmp_path / "bare.csv")[:, 1]
        np.testing.assert_allclose(forces["stiff"] - forces["bare"], 1500.0 * x, atol=1e-9)
        (tmp_path / "bare.csv").rename(sine)


def test_effects_that_have_no_say_are_told(sysid, tmp_path):
    card = tmp_path / "card.json"
    write_card(
        card_with(*(make(effect_kind(id)) for id in ("run_drift", "yield_temperature"))), card
    )
    said = sysid("simulate", card, *SINE, "-o", tmp_path / "f.csv")
    assert said.code == 0
    assert "Note: run_drift has no say here: the motion does not tell" in said.err
    assert "Note: yield_temperature has no say here: the temperature is not known" in said.err
    np.testing.assert_allclose(table(tmp_path / "f.csv")[:, 5], loop(), rtol=1e-9, atol=1e-9)


def test_its_own_table_is_a_motion_again(sysid, card_file, tmp_path):
    """Several cycles from a file, without the velocity: the same force inside the record."""
    t = np.arange(5 * 360) / 360 / 1.5
    x = 12.5 * np.sin(2 * np.pi * 1.5 * t)
    rows = [f"{a!r};{b!r};200" for a, b in zip(t.tolist(), x.tolist(), strict=True)]
    motion = tmp_path / "motion.csv"
    motion.write_text("\n".join(["time [s];displacement [mm];current [mA]", *rows]) + "\n")
    assert sysid("simulate", card_file, "--input", motion, "-o", tmp_path / "f.csv").code == 0
    force = table(tmp_path / "f.csv")[:, 5].reshape(5, 360)
    away = ~np.isin(np.arange(360), [0, 180])
    assert np.abs(force[1:4] - loop())[:, away].max() < 1e-6 * np.abs(loop()).max()
    said = sysid("simulate", card_file, "--input", tmp_path / "f.csv", "-o", tmp_path / "g.csv")
    assert said.code == 0
    error = np.abs(table(tmp_path / "g.csv")[:, 5] - force.ravel())
    assert error.max() < 0.01 * np.abs(force).max()


def test_causal_and_recorded_derivatives(sysid, card_file, tmp_path):
    t = np.arange(2000) / 1000
    x = 0.0125 * np.sin(2 * np.pi * 1.5 * t)
    v = 2 * np.pi * 1.5 * 0.0125 * np.cos(2 * np.pi * 1.5 * t)
    a = -((2 * np.pi * 1.5) ** 2) * x
    header = "time_s,displacement_m,velocity_m/s,acceleration_m/s2,current_A"
    np.savetxt(
        tmp_path / "m.csv", np.column_stack([t, x, v, a, 0.2 + 0 * t]), delimiter=",",
        header=header, comments="", fmt="%.17g",
    )  # fmt: skip
    np.savetxt(
        tmp_path / "x.csv", np.column_stack([t, x]), delimiter=",",
        header="time_s,displacement_m", comments="", fmt="%.17g",
    )  # fmt: skip
    given, causal = tmp_path / "given.csv", tmp_path / "causal.csv"
    assert sysid("simulate", card_file, "--input", tmp_path / "m.csv", "-o", given).code == 0
    order = ["--input", tmp_path / "x.csv", "--current", "0.2A", "--causal", "-o", causal]
    assert sysid("simulate", card_file, *order).code == 0
    exact, late = table(given)[:, 5], table(causal)
    np.testing.assert_array_equal(table(given)[:, 2], v)
    assert np.sqrt(np.mean((exact - late[:, 5])[10:] ** 2)) < 0.02 * np.abs(exact).max()
    backward = (3 * x[2:] - 4 * x[1:-1] + x[:-2]) / 2e-3
    np.testing.assert_allclose(late[2:, 2], backward, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("factor", "share"), [(-1.0, "-1"), (1e-3, "0.001"), (1e3, "1e+03")])
@pytest.mark.parametrize("with_velocity", [True, False])
def test_an_acceleration_that_is_not_the_rate_of_the_velocity_is_refused(
    factor, share, with_velocity, sysid, card_file, tmp_path
):
    t = np.arange(2000) / 1000
    turn = 2 * np.pi * 1.5
    x, v = 0.0125 * np.sin(turn * t), turn * 0.0125 * np.cos(turn * t)
    rng = np.random.default_rng(0)
    a = -(turn**2) * x * (1.0 + 0.0 * t) + rng.normal(0.0, 0.05, t.size)
    kept = [0, 1, 2, 3] if with_velocity else [0, 1, 3]
    names = np.array(["time_s", "displacement_m", "velocity_m/s", "acceleration_m/s2"])[kept]
    motion = tmp_path / "m.csv"
    for size, code in ((1.0, 0), (factor, 1)):
        columns = np.column_stack([t, x, v, size * a])[:, kept]
        np.savetxt(motion, columns, delimiter=",", header=",".join(names), comments="")
        said = sysid(
            "simulate", card_file, "--input", motion, "--current", "0.2A", "-o", tmp_path / "f.csv"
        )
        assert said.code == code, said.err
    assert "the column of acceleration is" in said.err


@pytest.mark.parametrize(("moved", "shaken"), [(0.1, 0.0), (1e-3, 3.0), (0.1, 1.0)])
def test_a_noisy_acceleration_is_taken_as_it_is(moved, shaken, sysid, card_file, tmp_path):
    """Noise of displacement and acceleration, in parts of their amplitudes."""
    t, turn, rng = np.arange(2000) / 1000, 2 * np.pi * 1.5, np.random.default_rng(1)
    x = np.sin(turn * t) + moved * rng.standard_normal(t.size)
    a = -(turn**2) * (np.sin(turn * t) + shaken * rng.standard_normal(t.size))
    np.savetxt(
        tmp_path / "m.csv", np.column_stack([t, 12.5 * x, 0.0125 * a]), delimiter=",",
        header="time_s,displacement_mm,acceleration_m/s2", comments="",
    )  # fmt: skip
    order = ["--input", tmp_path / "m.csv", "--current", "0.2A", "-o", tmp_path / "f.csv"]
    said = sysid("simulate", card_file, *order)
    assert "acceleration" not in said.err
    assert (tmp_path / "f.csv").exists()


@pytest.mark.parametrize(("factor", "code"), [(1.0, 0), (-1.0, 1), (1e-3, 1), (1e3, 1)])
@pytest.mark.parametrize("derived", [False, True])
def test_beside_a_noisy_displacement_only_a_wrong_velocity_is_refused(
    factor, code, derived, sysid, card_file, tmp_path
):
    """12.5 mm at 0.5 Hz with 0.02 mm of noise at 5 kHz; recorded, or derived and smoothed."""
    t, turn, rng = np.arange(20000) / 5000, np.pi, np.random.default_rng(2)
    x = 12.5 * np.sin(turn * t) + 0.02 * rng.standard_normal(t.size)
    v = 12.5 * turn * np.cos(turn * t)
    if derived:
        v = np.convolve(np.gradient(x, t), np.full(50, 0.02), mode="same")
    np.savetxt(
        tmp_path / "m.csv", np.column_stack([t, x, factor * v]), delimiter=",",
        header="time_s,displacement_mm,velocity_mm/s", comments="",
    )  # fmt: skip
    order = ["--input", tmp_path / "m.csv", "--current", "0.2A", "-o", tmp_path / "f.csv"]
    said = sysid("simulate", card_file, *order)
    assert (said.code, "the column of velocity is" in said.err) == (code, code == 1), said.err


def test_the_centre_has_the_sign_of_the_file(sysid, card_file, tmp_path):
    t = np.arange(1000) / 500
    rows = [f"{a!r},{float(30 - 12 * np.sin(9 * a))!r}" for a in t.tolist()]
    motion, manifest = tmp_path / "m.csv", tmp_path / "signs.toml"
    motion.write_text("\n".join(["time_s,displacement_mm", *rows]) + "\n")
    manifest.write_text('[campaign]\npositive_displacement = "extension"\n')
    order = ["simulate", card_file, "--input", motion, "--current", "0.1A", "--manifest", manifest]
    said = sysid(*order, "-o", tmp_path / "f.csv", "--centre", "30mm")
    assert said.code == 0
    assert "has a mean" not in said.err
    said = sysid(*order, "-o", tmp_path / "f.csv")
    assert said.code == 3
    assert "the displacement has a mean of 2" in said.err


def test_outside_validity_is_written_and_told_by_exit_3(sysid, card_file, tmp_path):
    out = tmp_path / "f.csv"
    order = ["--amplitude", "25mm", "--frequency", "5Hz", "--current", "0.6A"]
    order += ["--temperature", "60C"]
    said = sysid("simulate", card_file, *order, "-o", out, "--json")
    assert said.code == 3
    assert table(out).shape == (360, 6)
    assert not said.json["inside_validity"]
    told = " / ".join(said.json["outside"])
    for words in ("amplitude 25 mm", "velocity 0.7854 m/s", "current 0.6 A", "temperature 60 °C"):
        assert words in told
        assert words in said.err
    assert "frequency" not in told


def test_inside_validity_up_to_what_actuators_miss(sysid, card_file, tmp_path):
    order = ["simulate", card_file, "--frequency", "1Hz", "--current", "0A", "-o", tmp_path / "f"]
    assert sysid(*order, "--amplitude", "12.7mm").code == 0
    assert sysid(*order, "--amplitude", "12.8mm").code == 3


def test_a_displacement_off_its_centre_is_warned_of(sysid, card_file, tmp_path):
    t = np.arange(1000) / 500
    rows = [f"{a!r},{float(-30 + 12 * np.sin(9 * a))!r}" for a in t.tolist()]
    motion = tmp_path / "m.csv"
    motion.write_text("\n".join(["time_s,displacement_mm", *rows]) + "\n")
    order = ["simulate", card_file, "--input", motion, "--current", "0.1A", "-o"]
    order.append(tmp_path / "f.csv")
    said = sysid(*order)
    assert said.code == 3
    assert "displacement 42 mm is outside 0 to 12.5 mm" in said.err
    assert "the displacement has a mean of -2" in said.err
    said = sysid(*order, "--centre", "-30mm")
    assert said.code == 0
    assert "has a mean" not in said.err


@pytest.mark.parametrize(
    "extra",
    [
        ["--amplitude", "12.5mm", "--frequency", "1.5Hz"],
        ["--amplitude", "12.5N", "--frequency", "1.5Hz", "--current", "0A"],
        ["--amplitude", "12.5", "--frequency", "1.5Hz", "--current", "0A"],
        ["--amplitude", "-1mm", "--frequency", "1.5Hz", "--current", "0A"],
        [*SINE, "--causal"],
        [*SINE, "--centre", "1mm"],
        [*SINE, "--manifest", "campaign.toml"],
        ["--input", "motion.csv", *SINE],
    ],
)
def test_wrong_usage(extra, sysid, card_file, tmp_path):
    said = sysid("simulate", card_file, *extra, "-o", tmp_path / "f.csv")
    assert said.code == 2
    assert not (tmp_path / "f.csv").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("time_s,displacement_mm\n0,0\n1,1\n", "has no column for current"),
        ("time_s,current_A\n0,0\n1,1\n", "displacement"),
        ("time_s,displacement_mm,current_A\n0,0,0\n1,x,0\n2,1,0\n", "displacement is not a number"),
        ("time_s,displacement_mm,current_A\n0,0,0\n2,1,0\n1,1,0\n", "time goes backwards"),
        ("time_s,displacement_kg,current_A\n0,0,0\n1,1,0\n", "'kg' of displacement is not known"),
        ("time_s,displacement_mm,current_A\n0,0,0\n1,1,0\n", "2 samples are too few"),
        (
            "time_s,displacement_mm,velocity_mm/s,current_A\n"
            + "".join(f"{k / 10},{k * k},{-20.0 * k},0\n" for k in range(9)),
            "velocity is -1 times",
        ),
        ("time_s,displacement,current_A\n0,0,0\n1,1,0\n", "no unit is given for displacement"),
        ("", "is empty"),
    ],
)
def test_bad_motions_name_file_and_fault(content, message, sysid, card_file, tmp_path):
    motion = tmp_path / "motion.csv"
    motion.write_text(content)
    said = sysid("simulate", card_file, "--input", motion, "-o", tmp_path / "f.csv")
    assert said.code == 1
    assert message in said.err
    assert "motion.csv" in said.err
    assert not (tmp_path / "f.csv").exists()


def test_missing_files_and_places(sysid, card_file, tmp_path):
    gone = tmp_path / "gone"
    said = sysid("simulate", gone / "card.json", *SINE, "-o", tmp_path / "f.csv")
    assert (said.code, "the card cannot be read" in said.err) == (1, True)
    said = sysid("simulate", card_file, "--input", gone / "m.csv", "-o", tmp_path / "f.csv")
    assert (said.code, "cannot be read" in said.err) == (1, True)
    said = sysid("simulate", card_file, *SINE, "-o", gone / "f.csv")
    assert (said.code, "cannot be written: no such file" in said.err) == (1, True)
    said = sysid("simulate", card_file, *SINE, "-o", tmp_path)
    assert said.code == 1
    assert {p.name for p in tmp_path.iterdir()} == {"card.json"}


def test_a_full_disk_leaves_the_old_file(sysid, card_file, tmp_path, monkeypatch):
    out = tmp_path / "f.csv"
    out.write_text("old")

    def full(*args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    said = sysid("simulate", card_file, *SINE, "-o", out)
    monkeypatch.undo()
    assert said.code == 1
    assert "no space left on device" in said.err
    assert out.read_text() == "old"
    assert {p.name for p in tmp_path.iterdir()} == {"card.json", "f.csv"}


def test_what_is_read_is_not_written_over(sysid, card_file, tmp_path):
    motion = tmp_path / "motion.csv"
    table = "time_s,displacement_mm,current_A\n" + "".join(f"{k / 100},{k},0\n" for k in range(20))
    motion.write_text(table)
    card = card_file.read_bytes()
    (tmp_path / "link.csv").symlink_to(motion)
    for name in ("motion.csv", "link.csv", "card.json"):
        said = sysid("simulate", card_file, "--input", motion, "-o", tmp_path / name)
        assert said.code == 1
        assert "is read by this very command" in said.err
    os.mkfifo(tmp_path / "pipe")
    said = sysid("simulate", card_file, *SINE, "-o", tmp_path / "pipe")
    assert (said.code, "is no file" in said.err) == (1, True)
    assert motion.read_text() == table
    assert card_file.read_bytes() == card


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_a_force_that_is_not_finite_is_no_result(sysid, card_file, tmp_path):
    sine = ["--amplitude", "1e300mm", "--frequency", "1e9Hz", "--current", "0A"]
    said = sysid("simulate", card_file, *sine, "-o", tmp_path / "f.csv", "--json")
    assert said.code == 1
    assert "--amplitude and --frequency: the damper has no finite force" in said.err
    motion = tmp_path / "m.csv"
    rows = (f"{k}e-160,{1e14 * np.sin(k)},0" for k in range(50))
    motion.write_text("\n".join(["time_s,displacement_m,current_A", *rows]))
    order = ["--input", motion, "--causal", "-o", tmp_path / "f.csv"]
    said = sysid("simulate", card_file, *order)
    assert said.code == 1
    assert str(card_file) not in said.err
    assert f"{motion}: the damper has no finite force" in said.err
    assert not (tmp_path / "f.csv").exists()


def test_gaps_in_time_are_told(sysid, card_file, tmp_path):
    """Of half a cycle or a whole one; steps that a solver chose are none, nor another rate."""
    t = np.arange(2000) / 1000
    burst = np.cumsum(np.repeat([1e-1, 1e-3, 1e-1], [250, 1000, 249]))
    chosen = np.cumsum(np.where(np.arange(400) % 3, 1e-3, 8e-3))
    for name, time, told in (
        ("whole", t, False),
        ("torn", np.delete(t, slice(700, 1034)), True),
        ("cycle", np.delete(t, slice(700, 1366)), True),
        ("chosen", chosen, False),
        ("burst", burst, False),
        ("few slow", np.concatenate([np.arange(-40, 0) / 10, t]), False),
    ):
        rows = (f"{a!r},{float(12 * np.sin(3 * np.pi * a))!r},0.2" for a in time.tolist())
        motion = tmp_path / f"{name}.csv"
        motion.write_text("\n".join(["time_s,displacement_mm,current_A", *rows]))
        said = sysid("simulate", card_file, "--input", motion, "-o", tmp_path / "f.csv")
        assert said.code == 0, said.err
        assert ("time has a gap, of up to 0." in said.err) == told, name
        assert "gaps" not in said.err, name
        words = "a gap, of up to 0.335 s behind 0.699 s, where steps of 0.001 s"
        assert (words in said.err) == (name == "torn"), name


def test_a_rest_that_is_logged_slowly_and_noise_about_the_middle_are_no_gaps():
    rest = np.concatenate([np.arange(300) / 1000, [2.0, 2.001], 2.002 + np.arange(600) / 1000])
    x = np.where(rest < 2.002, 0.0, np.sin(6 * np.pi * (rest - 2.002)))
    assert _gaps_told(rest, x) == []
    assert len(_gaps_told(rest, np.sin(6 * np.pi * rest))) == 1
    t = np.delete(np.arange(2000) / 1000, slice(1200, 1240))
    slow = np.sin(np.pi * t) + 0.02 * np.random.default_rng(1).standard_normal(t.size)
    assert _gaps_told(t, slow) == [], "40 ms of a cycle of 2 s"


def test_the_encoding_of_the_manifest_counts(sysid, card_file, tmp_path):
    text = "# 試験機\ntime_s,変位,current_A\n"
    text += "".join(f"{k / 100},{float(np.sin(k / 10))!r},0.2\n" for k in range(200))
    (tmp_path / "m.csv").write_bytes(text.encode("shift_jis"))
    (tmp_path / "rig.toml").write_text(
        '[files]\nencoding = "shift_jis"\n'
        '[columns]\ndisplacement = { column = "変位", unit = "mm" }\n',
        encoding="utf-8",
    )
    order = ["--input", tmp_path / "m.csv", "--manifest", tmp_path / "rig.toml"]
    said = sysid("simulate", card_file, *order, "-o", tmp_path / "f.csv")
    assert said.code == 0, said.err


def test_a_temperature_that_nobody_tells_is_held_against_the_validity(sysid, tmp_path):
    """It is simulated at 40 °C, and 40 °C is outside."""
    made = card_with(make(effect_kind("gas_temperature")))
    cold = made.model_copy(
        update={"validity": made.validity.model_copy(update={"temperature": (11.0, 30.0)})}
    )
    write_card(cold, tmp_path / "cold.json")
    out = tmp_path / "f.csv"
    said = sysid("simulate", tmp_path / "cold.json", *SINE, "-o", out, "--json")
    assert said.code == 3
    assert said.json["outside"] == ["temperature 40 °C is outside 11 to 30 °C"]
    at_20 = sysid("simulate", tmp_path / "cold.json", *SINE, "--temperature", "20C", "-o", out)
    assert at_20.code == 0
