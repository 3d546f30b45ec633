"""A campaign: which files, which conditions, which signs, and what is said about them."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
from written_files import csv_text, measured, write

from sysid.data.campaign import load_campaign
from sysid.errors import DataError, ManifestError


def test_utfsm_is_read_by_its_manifest_alone(utfsm_folder, utfsm_manifest):
    campaign = load_campaign(utfsm_folder, utfsm_manifest)
    assert len(campaign.records) == 20
    assert campaign.notes == ()
    frame = campaign.to_frame().set_index("id")
    row = frame.loc["25mm0x25Hz_0x75A"]
    assert (row.amplitude_m, row.frequency_Hz, row.current_A) == pytest.approx((0.025, 0.25, 0.75))
    assert sorted(set(frame.sampling_rate_Hz.round(6))) == [200.0, 1000.0]
    for record in campaign.records:
        velocity = np.gradient(record.displacement, record.time)
        assert np.mean(record.force * velocity) > 0, f"{record.id} gives energy"
        assert np.mean(record.force) > 0, "gas pressure resists compression"


def test_frame_holds_conditions_size_and_provenance(make_campaign):
    folder = make_campaign([(10, 2, 0.5), (5, 4, 0)])
    frame = load_campaign(folder).to_frame().set_index("id")
    row = frame.loc["10mm_2Hz_0.5A"]
    data = (folder / "10mm_2Hz_0.5A.csv").read_bytes()
    assert row.sha256 == hashlib.sha256(data).hexdigest()
    assert (row.amplitude_m, row.frequency_Hz, row.current_A) == (0.01, 2.0, 0.5)
    assert row.samples == 400
    assert row.duration_s == pytest.approx(1.995)
    assert row.sampling_rate_Hz == pytest.approx(200.0)
    assert row.changes == "displacement converted from mm to m"


def test_precedence_of_conditions(tmp_path):
    """Recorded column > tests.csv > file name > manifest constants, and contradictions are said."""
    columns = {**measured(), "current_A": np.full(60, 0.25)}
    write(tmp_path, "5mm_2Hz_0.5A.csv", csv_text(columns))
    write(tmp_path, "8mm_3Hz.csv", csv_text(measured()))
    write(
        tmp_path,
        "tests.csv",
        "file;amplitude_mm;current_A;temperature_degC;run_order;kind\n"
        "5mm_2Hz_0.5A.csv;6;0,5;30;2;triangle\n8mm_3Hz.csv;;;;1;\n",
    )
    write(
        tmp_path,
        "campaign.toml",
        '[constants]\ntemperature = { value = 313.15, unit = "K", sd = 10 }\n'
        'current = { value = 750, unit = "mA" }\n',
    )
    campaign = load_campaign(tmp_path)
    second, first = campaign.records[1].nominal, campaign.records[0].nominal
    assert campaign.records[0].id == "8mm_3Hz", "ordered by run_order"
    assert second.current == 0.25
    assert second.amplitude == pytest.approx(0.006)
    assert second.frequency == 2.0
    assert (second.temperature, second.temperature_sd) == (30.0, None)
    assert (second.kind, second.run_order) == ("triangle", 2)
    assert first.amplitude == pytest.approx(0.008)
    assert first.current == pytest.approx(0.75)
    assert first.temperature == pytest.approx(40.0)
    assert first.temperature_sd == 10.0
    notes = " ".join(campaign.notes)
    assert "tests.csv says amplitude 6 mm, the file name says 5 mm; tests.csv is taken" in notes
    assert "the recorded current is 0.25 A; the recorded one is taken" in notes


def test_a_noisy_recorded_current_that_agrees_leaves_the_label(tmp_path):
    noise = np.random.default_rng(1).normal(0, 0.004, 60)
    write(tmp_path, "a_0.5A.csv", csv_text({**measured(), "current_A": 0.497 + noise}))
    write(tmp_path, "b.csv", csv_text({**measured(), "current_A": 0.497 + noise}))
    labelled, bare = load_campaign(tmp_path).records
    assert labelled.nominal.current == 0.5
    assert bare.nominal.current == pytest.approx(0.497, abs=0.004)


def test_tests_csv_warns_of_what_it_does_not_list_and_of_what_it_cannot_use(make_campaign):
    folder = make_campaign()
    write(folder, "tests.csv", "file,operator\n10mm_2Hz_0A.csv,me\n")
    notes = " ".join(load_campaign(folder).notes)
    assert "10mm_2Hz_0.5A.csv: is not listed in tests.csv" in notes
    assert "column 'operator' is not read" in notes


def test_tests_csv_lists_parts_of_a_file(tmp_path):
    text = csv_text(measured())
    write(tmp_path, "daq.csv", text + text)
    write(tmp_path, "tests.csv", "file,current_A\ndaq.csv#2,1\ndaq.csv,0\n")
    one, two = load_campaign(tmp_path).records
    assert (one.nominal.current, two.nominal.current) == (0.0, 1.0)


def test_a_folder_for_each_current(tmp_path):
    """Files of one name in several folders, whose names tell what the file's does not."""
    for ampere in (0, 0.5):
        folder = tmp_path / "day 1" / f"{ampere}A"
        folder.mkdir(parents=True)
        for name in ("10mm_2Hz.csv", f"5mm_2Hz_{ampere}.csv"):
            write(folder, name, csv_text(measured(current=ampere)))
    write(tmp_path / "day 1" / "0.5A", "8mm_2Hz_0.4A.csv", csv_text(measured()))
    write(tmp_path, "campaign.toml", '[files]\nglob = "*/*/*.csv"\n')
    campaign = load_campaign(tmp_path)
    assert {r.id: r.nominal.current for r in campaign.records} == {
        "day 1/0A/10mm_2Hz": 0.0, "5mm_2Hz_0": 0.0, "day 1/0.5A/10mm_2Hz": 0.5, "5mm_2Hz_0.5": 0.5,
        "8mm_2Hz_0.4A": 0.4,
    }  # fmt: skip
    assert "2 names (0.5A, 0A): the folder's name tells current" in campaign.notes
    (note,) = (note for note in campaign.notes if "8mm" in note)
    assert "the file name says current 0.4 A, the folder '0.5A' says 0.5 A" in note


def test_folders_tell_nothing_beside_a_pattern(tmp_path):
    (tmp_path / "0.5A").mkdir()
    write(tmp_path / "0.5A", "a10mm.csv", csv_text(measured()))
    write(tmp_path, "campaign.toml", '[files]\nglob = "*/*.csv"\nname = "a{amplitude}mm"\n')
    (record,) = load_campaign(tmp_path).records
    assert (record.nominal.amplitude, record.nominal.current) == (0.01, None)


def test_signs_by_the_manifest_and_by_request(make_campaign):
    folder = make_campaign([(10, 2, 0.5)])
    (plain,) = load_campaign(folder).records
    (flipped,) = load_campaign(folder, flip_force=True).records
    np.testing.assert_array_equal(flipped.force, -plain.force)
    np.testing.assert_array_equal(flipped.displacement, plain.displacement)
    assert "sign of force turned: asked for by --flip-force" in flipped.source.changes
    write(
        folder,
        "campaign.toml",
        '[campaign]\npositive_force = "extension"\npositive_displacement = "extension"\n',
    )
    (turned,) = load_campaign(folder).records
    np.testing.assert_array_equal(turned.force, -plain.force)
    np.testing.assert_array_equal(turned.displacement, -plain.displacement)
    assert sum("manifest says extension" in c for c in turned.source.changes) == 2


def test_a_force_that_opposes_its_velocity_is_not_flipped_silently(tmp_path):
    columns = measured()
    columns["force_N"] = -columns["force_N"]
    write(tmp_path, "a.csv", csv_text(columns))
    (record,) = load_campaign(tmp_path).records
    np.testing.assert_allclose(record.force, columns["force_N"])
    assert not any("sign" in change for change in record.source.changes)


NAMED = '[campaign]\nname = "elsewhere"\n[files]\nfolder = "data"\n'


def test_a_manifest_elsewhere_serves_the_folder_that_is_given(make_campaign, tmp_path):
    folder = make_campaign()
    manifest = write(tmp_path, "rig.toml", '[campaign]\nname = "elsewhere"\n')
    campaign = load_campaign(folder, manifest)
    assert campaign.name == "elsewhere"
    assert campaign.folder == folder
    assert len(campaign.records) == 2
    assert campaign.notes == ()


def test_a_manifest_elsewhere_names_the_folder_where_the_given_one_has_no_data(
    make_campaign, tmp_path
):
    folder = make_campaign(name="data")
    (tmp_path / "empty").mkdir()
    manifest = write(tmp_path, "rig.toml", NAMED)
    campaign = load_campaign(tmp_path / "empty", manifest)
    assert campaign.folder.samefile(folder)
    assert len(campaign.records) == 2


def test_where_both_folders_have_data_the_given_one_counts_and_it_is_said(make_campaign, tmp_path):
    make_campaign(name="data")
    given = make_campaign([(5, 1, 0)], name="given")
    campaign = load_campaign(given, write(tmp_path, "rig.toml", NAMED))
    assert [r.id for r in campaign.records] == ["5mm_1Hz_0A"]
    assert "given are read, not those in" in campaign.notes[0]


def test_a_manifest_in_the_campaign_names_its_data_folder(make_campaign, tmp_path):
    make_campaign(name="data")
    write(tmp_path, "campaign.toml", NAMED)
    assert [r.source.file for r in load_campaign(tmp_path).records] == [
        "10mm_2Hz_0.5A.csv", "10mm_2Hz_0A.csv",
    ]  # fmt: skip


def test_names_with_blanks_and_other_letters_and_capitals(tmp_path):
    folder = tmp_path / "мой стенд 試験"
    folder.mkdir()
    for name in ("Dämpfer 5mm 2Hz.csv", "阻尼器.CSV"):
        write(folder, name, csv_text(measured()))
    assert [r.id for r in load_campaign(folder).records] == ["Dämpfer 5mm 2Hz", "阻尼器"]


def test_hidden_files_are_left_out_and_said(make_campaign):
    folder = make_campaign()
    write(folder, "._10mm.csv", b"\x00\x05\x16\x07")
    campaign = load_campaign(folder)
    assert len(campaign.records) == 2
    assert "._10mm.csv is a hidden file" in campaign.notes[0]


def test_a_folder_with_other_formats_says_what_to_write(tmp_path):
    write(tmp_path, "a.tdms", b"TDSm")
    with pytest.raises(DataError, match=r'glob = "\*\.tdms"'):
        load_campaign(tmp_path)


def test_a_listed_file_that_is_absent_is_an_error(make_campaign):
    folder = make_campaign()
    write(folder, "tests.csv", "file\n10mm_2Hz_0A.csv\ngone.csv\n")
    with pytest.raises(ManifestError, match=r"gone\.csv") as caught:
        load_campaign(folder)
    assert "tests.csv, line 3" in str(caught.value)


@pytest.mark.parametrize(("name", "right"), [("Campaign.toml", "campaign.toml"),
                                             ("campaign.toml.txt", "campaign.toml"),
                                             ("Tests.csv", "tests.csv")])  # fmt: skip
def test_a_manifest_that_would_not_be_read_is_told(tmp_path: Path, name: str, right: str) -> None:
    write(tmp_path, "5mm_2Hz_0.5A.csv", csv_text(measured()))
    write(tmp_path, name, "")
    if (tmp_path / right).exists():
        pytest.skip("this file system does not tell upper from lower case")
    with pytest.raises(ManifestError, match=f"Rename it to {right}"):
        load_campaign(tmp_path)


@pytest.mark.parametrize("factor", [1000.0, 0.001])
def test_a_recorded_current_in_another_unit_is_refused(tmp_path: Path, factor: float) -> None:
    columns = {**measured(), "current_A": np.full(60, 0.5 * factor)}
    write(tmp_path, "5mm_2Hz_0.5A.csv", csv_text(columns))
    with pytest.raises(DataError, match="1000 times apart"):
        load_campaign(tmp_path)


def test_a_listing_may_end_its_lines_with_separators(tmp_path: Path) -> None:
    write(tmp_path, "a.csv", csv_text(measured()))
    write(tmp_path, "tests.csv", "file,current_A\na.csv,0.25,, \n")
    assert load_campaign(tmp_path).records[0].nominal.current == 0.25


def test_a_listing_is_looked_for_where_the_data_are(tmp_path: Path) -> None:
    (tmp_path / "raw").mkdir()
    write(tmp_path, "campaign.toml", '[files]\nfolder = "raw"\n')
    write(tmp_path / "raw", "5mm_2Hz_0.5A.csv", csv_text(measured()))
    write(tmp_path / "raw", "tests.csv.txt", "file\n5mm_2Hz_0.5A.csv\n")
    with pytest.raises(ManifestError, match=r"Rename it to tests\.csv"):
        load_campaign(tmp_path)


def test_a_temperature_below_absolute_zero_is_refused(tmp_path: Path) -> None:
    write(tmp_path, "5mm_2Hz_0.5A.csv", csv_text(measured()))
    write(tmp_path, "tests.csv", "file,temperature_degC\n5mm_2Hz_0.5A.csv,-400\n")
    with pytest.raises(DataError, match="-400 °C is below absolute zero"):
        load_campaign(tmp_path)
