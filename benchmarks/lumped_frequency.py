"""BS09's puzzle: is a law of frequency found with the tests that can show it, and only there?

Each campaign is the rig's `virtual-bs09-frequency` with other random numbers: 72 raw files with
noise, errors of the rig and a damper that heats, read and cut as any other.  It is diagnosed twice
on the lumped base: as it is, and with the paper's two excitations alone.  What it has beside them
are the two tests that the diagnosis asks for when it sees these alone (checked in every campaign).
A third campaign has 20 mm 4 Hz and 2.5 mm 8 Hz instead: each of the paper's two speeds at the other
frequency, which is an octave away, where what the diagnosis asks for spans two.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from outcome import RESULTS, Outcome
from study import run_study, study_parser
from work_file import FOLDER, read_rows

from sysid.jobs.job import Ended
from sysid.jobs.rows import shortened
from sysid.trials.program import fingerprint
from sysid.trials.proportions import Share

if TYPE_CHECKING:
    from sysid.data.loops import Loops
    from sysid.diagnosis.result import Diagnosis

WORK: Final = RESULTS / "lumped_frequency.jsonl"
PROGRAM: Final = fingerprint(
    ("arrays.py", "cli/selection.py", "data", "diagnosis", "effects", "identification",
     "likelihood", "models", "motion", "parameters.py", "rig", "units.py"), ("rig/physical",),
)  # fmt: skip
"""Rows count for the program that made and diagnosed the campaigns."""
ASKED: Final = "asked for"
SWAPPED: Final = "swapped"
ALONE: Final = "the paper's alone"
KINDS: Final = (ASKED, ALONE, SWAPPED)
"""Excitations: the paper's and what the diagnosis asks for; the paper's; the paper's and each of
its speeds at the other frequency."""
PAPER: Final = ((10e-3, 8.0), (5e-3, 4.0))
"""m, Hz."""
OTHERS: Final = ((20e-3, 4.0), (2.5e-3, 8.0))
"""m, Hz: the same two speeds at the other frequency."""
TOGETHER: Final = 0.03
"""Logarithm of amplitude or frequency within which a test is one that was asked for."""
LAW: Final = "frequency_law"
TRUE: Final = frozenset(
    {LAW, "force_offset", "gas_temperature", "self_heating", "seal_friction", "surface_temperature"}
)
"""What is in the rig: the hidden law, gas that warms, oil that a test heats, of which the
thermometer lags behind by a second, and a yield force at 0 A that grows with temperature."""
PLANTED: Final = 0.05
"""Per decade."""
SAID: Final = "cannot be told from a law of speed"
CAMPAIGNS: Final = 100
FIRST_SEED: Final = 500


@dataclass(frozen=True)
class Answer:
    """One diagnosis.

    Attributes:
        seed: Of the campaign.
        kind: Of its excitations, one of `KINDS`.
        asks: The tests that the diagnosis asks for are those of the campaign `ASKED`; None where
            frequency is not tied to speed.
        status: Of the frequency law: named, class, family; None where it is not asserted.
        members: Of its class.
        confidence: Of it.
        listed: It is said that these tests cannot tell it from a law of speed, and which would.
        dprime: What the screen could see of it: 5 % per decade over its standard error.
        size: Identified change per decade, with its interval.
        others: Every other id that is asserted.
        before: Held-out RMSE/max|F| of the base.
        after: With what was added.
        seconds: Wall time of the diagnosis.
    """

    seed: int
    kind: str
    asks: bool | None
    status: str | None
    members: tuple[str, ...]
    confidence: float
    listed: bool
    dprime: float
    size: tuple[float, float, float]
    others: tuple[str, ...]
    before: float
    after: float
    seconds: float

    @property
    def false_names(self) -> tuple[str, ...]:
        """Names that are neither hidden nor a part of the damper."""
        return tuple(id for id in self.others if id not in TRUE)

    @property
    def found(self) -> bool:
        """The law is asserted, as one of several that these tests cannot tell apart."""
        return self.status == "class" and len(self.members) > 1

    @property
    def inseparable(self) -> bool:
        """It is said that a law of frequency cannot be told from one of speed."""
        return self.found or self.listed


def main() -> None:
    """Diagnose what is missing, and write the page of all of it."""
    parser = study_parser(__doc__ or "", "one campaign")
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS, help="of each kind")
    given = parser.parse_args()
    file = FOLDER / "lumped_frequency.quick.jsonl" if given.quick else WORK
    seeds = range(FIRST_SEED, FIRST_SEED + (1 if given.quick else given.campaigns))
    names = [f"{kind}:{seed}" for seed in seeds for kind in (ASKED, ALONE)]
    names += [f"{SWAPPED}:{seed}" for seed in seeds]
    if not given.page:
        run_study(names, work, file, PROGRAM, processes=given.processes, words=words)
    rows = [row for row in read_rows(file) if row["id"] in set(names)]
    if not rows:
        sys.exit(f"No campaign is finished in {file}: run this without --page")
    page([_read(row) for row in rows]).finish(keep=not given.quick)


def work(name: str) -> dict[str, Any]:
    """One campaign by its name, diagnosed."""
    kind, number = name.split(":")
    seed = int(number)
    loops = campaign(seed, OTHERS if kind == SWAPPED else None)
    answer = diagnosed(of_the_paper(loops) if kind == ALONE else loops, kind, seed)
    return {"id": name, **shortened(asdict(answer)), "program": PROGRAM}


def words(ended: Ended) -> str:
    """What became of the law of frequency, in a few words."""
    row = ended.row or {}
    law = row["status"] or ("inseparable from laws of speed" if row["listed"] else "not told")
    beside = ", ".join(row["others"]) or "nothing"
    return f"{row['kind']}: {law}; {beside} beside"


def campaign(seed: int, beside: tuple[tuple[float, float], ...] | None = None) -> "Loops":
    """Steady loops of one campaign, through files.

    Args:
        seed: Of its random numbers.
        beside: Excitations beside the paper's, m and Hz, in place of the scenario's.
    """
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.rig.lumped_damper import CURRENTS
    from sysid.rig.scenarios.virtual_bs09_frequency import VIRTUAL_BS09_FREQUENCY
    from sysid.rig.sweep import warm_factorial
    from sysid.rig.sweep_campaign import make_sweep

    sweep = VIRTUAL_BS09_FREQUENCY
    if beside is not None:
        settings = warm_factorial((*PAPER, *beside), (15.0, 45.0, 75.0), CURRENTS)
        sweep = replace(sweep, settings=settings)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, content in make_sweep(sweep, seed).items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)
        return select(load_campaign(folder), (), ()).loops


def of_the_paper(loops: "Loops") -> "Loops":
    """The tests with one of the paper's two excitations."""
    motion = np.log(np.stack([loops.amplitude, loops.frequency], axis=1))
    near = [(np.abs(motion - np.log(z)) < 0.1).all(axis=1) for z in PAPER]
    return loops.select(np.logical_or.reduce(near))


def diagnosed(loops: "Loops", kind: str, seed: int) -> Answer:
    """Diagnose loops on the lumped base."""
    from sysid.diagnosis.diagnose import diagnose_loops

    begin = time.perf_counter()
    found = diagnose_loops(loops, models=(("lumped", "paper"),), seed=seed)
    return _answer(found, kind, seed, time.perf_counter() - begin)


def _answer(found: "Diagnosis", kind: str, seed: int, seconds: float) -> Answer:
    law = next((c for c in found.causes if LAW in c.members), None)
    screened = next(row for row in found.screen if row.id == LAW)
    size = (float("nan"), float("nan"), float("nan"))
    if law is not None and law.effect.facts.id == LAW:
        q = law.parameters[0]
        size = (q.value, q.low, q.high)
    gain = found.gain
    return Answer(
        seed=seed,
        kind=kind,
        asks=_asks(found.loops),
        status=None if law is None else law.status,
        members=() if law is None else law.members,
        confidence=0.0 if law is None else law.confidence,
        listed=any(z.id == LAW and SAID in z.because for z in found.invisible),
        dprime=PLANTED / screened.se,
        size=size,
        others=tuple(str(c.id or c.family) for c in found.causes if c is not law),
        before=found.base.held_out_nrmse if gain is None else gain.before,
        after=float("nan") if gain is None else gain.after,
        seconds=seconds,
    )


def _asks(loops: "Loops") -> bool | None:
    """Whether the tests that would tell are those that the scenario adds to the paper's."""
    from sysid.diagnosis.tied import frequency_is_tied, untying_tests
    from sysid.rig.scenarios.virtual_bs09_frequency import TELLING

    if not frequency_is_tied(loops):
        return None
    asked = np.log(np.array(untying_tests(loops)))
    return asked.shape == (2, 2) and bool((np.abs(asked - np.log(TELLING)) < TOGETHER).all())


def page(answers: Sequence[Answer]) -> Outcome:
    """Rates with their intervals, beside what is asked for."""
    outcome = Outcome("lumped_frequency", "BS09's puzzle: a law of frequency, hidden and found")
    outcome.say(*(__doc__ or "").split("\n\n", 1)[1].split("\n"))
    asked, alone, swapped = ([a for a in answers if a.kind == kind] for kind in KINDS)
    rows = [
        ("**the paper's two and those asked for**: the law is named", _named(asked), "≥ 90 %"),
        ("any other cause that is not there", _false(asked), ""),
        ("its interval holds the 5 % per decade", _covered(asked), ""),
        ("**the paper's two and both speeds swapped**: the law is named", _named(swapped), ""),
        ("any other cause that is not there", _false(swapped), ""),
        ("its interval holds the 5 % per decade", _covered(swapped), ""),
        ("**the paper's two**: called inseparable from laws of speed", _apart(alone), "≥ 95 %"),
        ("asserted, as a class with these", _share(alone, lambda a: a.found), ""),
        ("the law, or anything that is not there, is named", _wrong(alone), "never"),
        ("the two tests that it asks for are those above", _share(alone, lambda a: bool(a.asks)),
         "always"),
    ]  # fmt: skip
    outcome.table(("", "campaigns", "aim"), [row for row in rows if row[1].trials])
    for kind, own in ((ASKED, asked), (SWAPPED, swapped)):
        sizes = np.array([a.size[0] for a in own if np.isfinite(a.size[0])])
        if sizes.size:
            outcome.say(
                f"Identified ({kind}): {100 * np.median(sizes):.2f} % per decade in the median, "
                f"standard deviation over campaigns {100 * sizes.std():.2f} %. Held-out error: "
                f"{100 * np.mean([a.before for a in own]):.2f} % before, "
                f"{100 * np.nanmean([a.after for a in own]):.2f} % after."
            )
    dprime = [
        f"{np.median([a.dprime for a in own]):.1f} ({kind})"
        for kind, own in zip(KINDS, (asked, alone, swapped), strict=True)
        if own
    ]
    outcome.say(
        f"The law over its standard error in the screen, d', in the median: {', '.join(dprime)}."
    )
    outcome.say(f"Other causes that are not there: {_counts(answers)}.")
    shares = {
        "named": _named(asked), "false": _false(asked), "covered": _covered(asked),
        "named_swapped": _named(swapped), "inseparable": _apart(alone), "misnamed": _wrong(alone),
    }  # fmt: skip
    outcome.numbers = {
        **{name: share.as_dict() for name, share in shares.items() if share.trials},
        "seconds": float(np.median([a.seconds for a in answers])),
    }
    return outcome


def _share(answers: Sequence[Answer], holds: Callable[[Answer], bool]) -> Share:
    return Share(sum(holds(a) for a in answers), len(answers))


def _named(answers: Sequence[Answer]) -> Share:
    return _share(answers, lambda a: a.status == "named")


def _false(answers: Sequence[Answer]) -> Share:
    return _share(answers, lambda a: bool(a.false_names))


def _apart(answers: Sequence[Answer]) -> Share:
    return _share(answers, lambda a: a.inseparable)


def _wrong(answers: Sequence[Answer]) -> Share:
    return _share(answers, lambda a: a.status == "named" or bool(a.false_names))


def _covered(answers: Sequence[Answer]) -> Share:
    known = [a for a in answers if np.isfinite(a.size[0])]
    return _share(known, lambda a: a.size[1] <= PLANTED <= a.size[2])


def _counts(answers: Sequence[Answer]) -> str:
    ids = [id for a in answers for id in a.false_names]
    return ", ".join(f"{id} ({ids.count(id)})" for id in sorted(set(ids))) or "none"


def _read(row: dict[str, Any]) -> Answer:
    own: dict[str, Any] = {
        k: tuple(v) if isinstance(v, list) else v
        for k, v in row.items()
        if k not in ("id", "program")
    }
    return Answer(**own)


if __name__ == "__main__":
    main()
