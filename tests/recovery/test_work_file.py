"""Work files of long studies: what is finished counts, what was cut off is done again."""

from work_file import finished, keep


def test_rows_come_back_and_a_line_that_was_cut_off_spoils_no_other(tmp_path):
    file = tmp_path / "build" / "study.jsonl"
    assert finished(file) == []
    keep({"seed": 1, "größe": 2.5}, file)
    keep({"seed": 2}, file)
    with file.open("a", encoding="utf-8") as out:
        out.write('{"seed": 3, "hi')
    assert finished(file) == [{"seed": 1, "größe": 2.5}, {"seed": 2}]
    keep({"seed": 3}, file)
    assert [row["seed"] for row in finished(file)] == [1, 2, 3]
