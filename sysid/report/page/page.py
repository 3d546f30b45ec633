"""Everything that stands on one page."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sysid.data.tolerance import Tolerance
from sysid.report.page.comparison import Comparison
from sysid.report.page.damper_table import DamperTable, damper_table, facts
from sysid.report.page.headline import Headline
from sysid.report.page.look import MEASURED, looks
from sysid.report.page.loop_figure import DISPLACEMENT, VELOCITY, LoopFigure, loop_figures
from sysid.report.page.matrix import Matrix, matrix
from sysid.report.page.one_test import OneTest, worst_of
from sysid.report.page.open_ends import OpenEnds
from sysid.report.page.packed import packed_test
from sysid.report.page.parameter_table import ParameterTable
from sysid.report.page.provenance import Provenance
from sysid.report.page.screened import Screened, chart_of
from sysid.report.page.symmetry import Left


@dataclass(frozen=True)
class Page:
    """A page; sections that do not apply are empty or None.

    Attributes:
        title: Of the window.
        what: "Fit", "Diagnosis" or "Comparison".
        measured: What the measured curves are.
        models: Names of the models, the worse-informed first.
        headline: Verdict and gain.
        tests: All tests of the campaign.
        worst: Place of the test with the largest error of the first model.
        table: Of a damper engineer.
        matrix: All tests with their errors.
        left: What each model leaves.
        screen: Effects against thresholds.
        parameters: One table a card.
        open: What is open, and what to test next.
        comparison: Cards against each other.
        provenance: Where it all comes from.
        errors_are: What tests' errors are, where it is not what the curves show; a clause.
    """

    title: str
    what: str
    measured: str
    models: tuple[str, ...]
    headline: Headline
    tests: tuple[OneTest, ...]
    worst: int | None
    table: DamperTable
    matrix: Matrix
    left: tuple[Left, ...]
    screen: tuple[Screened, ...]
    parameters: tuple[ParameterTable, ...]
    open: OpenEnds | None
    comparison: Comparison | None
    provenance: Provenance
    errors_are: str = ""

    @property
    def worst_test(self) -> OneTest | None:
        """The test on the first screen."""
        return None if self.worst is None else self.tests[self.worst]

    @property
    def worst_loops(self) -> tuple[LoopFigure, ...]:
        """Force over velocity and over displacement of that test."""
        test = self.worst_test
        if test is None or test.traces is None:
            return ()
        return loop_figures(test.traces, self.measured, self.models)

    def data(self) -> dict[str, Any]:
        """What the script draws from."""
        labels = {cell.id: cell.label for cell in self.matrix.cells}
        return {
            "models": list(self.models),
            "measured": self.measured,
            "along": {"velocity": VELOCITY, "displacement": DISPLACEMENT},
            "worst": self.worst,
            "looks": {
                "measured": MEASURED.json(),
                "models": [look.json() for look in looks(len(self.models))],
            },
            "tests": [
                packed_test(t)
                | {"facts": [] if t.traces is None else facts(t, self.models, self.table.of(t.id))}
                for t in self.tests
            ],
            "labels": [labels[t.id] for t in self.tests],
            "damper": list(self.table.chart),
            "limits": list(self.table.limits),
            "parity": [
                {"model": z.model, "shares": [[k.parity, k.meaning, k.share] for k in z.kinds]}
                for z in self.left
            ],
            "screen": chart_of(self.screen),
        }


def make_page(
    *,
    title: str,
    what: str,
    models: Sequence[str],
    headline: Headline,
    tests: Sequence[OneTest],
    provenance: Provenance,
    measured: str = "measured",
    left: tuple[Left, ...] = (),
    screen: tuple[Screened, ...] = (),
    parameters: tuple[ParameterTable, ...] = (),
    open_ends: OpenEnds | None = None,
    comparison: Comparison | None = None,
    tolerance: Tolerance | None = None,
    errors_are: str = "",
) -> Page:
    """Put sections together; those that follow from the tests alone are gathered here.

    Args:
        title: Of the window.
        what: "Fit", "Diagnosis" or "Comparison".
        models: Names, the worse-informed first.
        headline: Verdict and gain.
        tests: All tests.
        provenance: Where it comes from.
        measured: What the measured curves are.
        left: What each model leaves.
        screen: Effects against thresholds.
        parameters: One table a card.
        open_ends: What is open.
        comparison: Cards against each other.
        tolerance: What the damper's drawing allows.
        errors_are: What tests' errors are, where it is not what the curves show.
    """
    return Page(
        title=title, what=what, measured=measured, models=tuple(models), headline=headline,
        tests=tuple(tests), worst=worst_of(tests), table=damper_table(tests, models[-1], tolerance),
        matrix=matrix(tests, models), left=left, screen=screen, parameters=parameters,
        open=open_ends, comparison=comparison, provenance=provenance,
        errors_are=errors_are,
    )  # fmt: skip
