"""What holds of every figure that is written."""

from matplotlib.figure import Figure

from sysid.report.figure import TICKS, png


def test_powers_of_ten_are_written_and_dollars_of_names_are_no_formula():
    figure = Figure()
    ax = figure.subplots()
    ax.plot([1e-3, 1e2], [0.0, 1.0])
    ax.set_xscale("log")
    ax.set_yticks([0.0, 1.0], ["costs $5 {", "and $6"])
    ax.set_title("rig $_{")
    assert png(figure).startswith(b"\x89PNG")
    written = [t for t in ax.get_xticklabels() if TICKS in t.get_text()]
    assert written
    assert all(t.get_parse_math() for t in written)
    assert not ax.title.get_parse_math()
    assert [t.get_text() for t in ax.get_yticklabels()] == ["costs $5 {", "and $6"]
