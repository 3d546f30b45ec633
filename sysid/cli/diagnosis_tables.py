"""A diagnosis for people: sentences first, then compact tables."""

from rich.table import Table

from sysid.cli.console import Talk
from sysid.cli.diagnosed import Diagnosed, Held
from sysid.diagnosis.result import Cause, Diagnosis, Invisible
from sysid.diagnosis.sentences import sentences
from sysid.diagnosis.words import amount_beside_name, percent, plain


def show_diagnosis(talk: Talk, result: Diagnosed) -> None:
    """Print the answer."""
    d = result.diagnosis
    for sentence in d.sentences or sentences(d):
        talk.say(sentence)
    talk.say("")
    if d.causes:
        talk.show(cause_table(d.causes))
    talk.show(error_table(d, result.holdout))
    if d.invisible:
        talk.show(invisible_table(d.invisible))


def cause_table(causes: tuple[Cause, ...]) -> Table:
    """What was found, one row a parameter, strongest cause first."""
    table = Table(title="Causes", caption="intervals: 95 %")
    for name in ("cause", "answer", "confidence", "parameter", "value"):
        table.add_column(name, justify="right" if name == "confidence" else "left")
    table.add_column("adds, RMS", justify="right")
    table.add_column("removes", justify="right")
    for c in causes:
        head = (
            c.id or f"family {c.family}",
            c.status if c.status != "class" else f"class: {', '.join(c.members)}",
            percent(c.confidence),
        )
        tail = (f"{plain(c.extra_error)} N", percent(c.share))
        for k, q in enumerate(c.parameters):
            first = k == 0
            table.add_row(
                *(head if first else ("",) * 3), f"{q.symbol}: {q.name}", amount_beside_name(q),
                *(tail if first else ("",) * 2),
            )  # fmt: skip
    return table


def error_table(d: Diagnosis, holdout: tuple[Held, ...]) -> Table:
    """Errors before and after, mean over tests, and of every test of --holdout."""
    table = Table(title="Error on tests that were not fitted, RMSE of max|F|")
    table.add_column("tests")
    table.add_column(f"base ({d.base.model}, {d.base.variant})", justify="right")
    table.add_column("extended", justify="right")
    if d.gain is None:
        table.add_row("each left out in turn", percent(d.base.held_out_nrmse), "–")
    else:
        table.add_row("each left out in turn", percent(d.gain.before), percent(d.gain.after))
        table.add_row("noise of the mean cycle", "", percent(d.gain.floor))
        table.add_row("repeatability: scatter of one cycle", "", percent(d.gain.repeatability))
        for what, before, after in d.gain.extrapolation:
            table.add_row(f"left out: {what}", percent(before), percent(after))
    for id, before, after in sorted(holdout, key=lambda z: (-z[1], z[0])):
        table.add_row(id, percent(before), percent(after))
    return table


def invisible_table(invisible: tuple[Invisible, ...]) -> Table:
    """What these tests cannot show, and the test that would."""
    table = Table(title="Cannot be seen in these tests (and so is not excluded)")
    for name in ("effect", "because", "a test that would show it"):
        table.add_column(name)
    for z in invisible:
        table.add_row(z.id, z.because, z.test)
    return table
