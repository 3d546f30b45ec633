"""BS09's puzzle: is a law of frequency found with the tests that can show it, and only there?

Each campaign is the rig's `virtual-bs09-frequency` with other random numbers: 72 raw files with
noise, errors of the rig and a damper that heats, read and cut as any other.  It is diagnosed twice
on the lumped base: as it is, and with the paper's two excitations alone.
"""

import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
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
KINDS: Final = (4, 2)
"""Excitations."""
PAPER: Final = ((10e-3, 8.0), (5e-3, 4.0))
"""m, Hz."""
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
        excitations: How many it has.
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
    excitations: int
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
    names = [f"{excitations}:{seed}" for seed in seeds for excitations in KINDS]
    if not given.page:
        run_study(names, work, file, PROGRAM, processes=given.processes, words=words)
    rows = [row for row in read_rows(file) if row["id"] in set(names)]
    if not rows:
        sys.exit(f"No campaign is finished in {file}: run this without --page")
    page([_read(row) for row in rows]).finish(keep=not given.quick)


def work(name: str) -> dict[str, Any]:
    """One campaign by its name, diagnosed with four or two excitations."""
    excitations, seed = (int(z) for z in name.split(":"))
    loops = campaign(seed)
    answer = diagnosed(loops if excitations == 4 else of_the_paper(loops), seed)
    return {"id": name, **shortened(asdict(answer)), "program": PROGRAM}


def words(ended: Ended) -> str:
    """What became of the law of frequency, in a few words."""
    row = ended.row or {}
    law = row["status"] or ("inseparable from laws of speed" if row["listed"] else "not told")
    beside = ", ".join(row["others"]) or "nothing"
    return f"{row['excitations']} excitations: {law}; {beside} beside"


def campaign(seed: int) -> "Loops":
    """Steady loops of one campaign, through files."""
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.rig.scenarios.virtual_bs09_frequency import VIRTUAL_BS09_FREQUENCY
    from sysid.rig.sweep_campaign import make_sweep

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, content in make_sweep(VIRTUAL_BS09_FREQUENCY, seed).items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)
        return select(load_campaign(folder), (), ()).loops


def of_the_paper(loops: "Loops") -> "Loops":
    """The tests with one of the paper's two excitations."""
    motion = np.log(np.stack([loops.amplitude, loops.frequency], axis=1))
    near = [(np.abs(motion - np.log(z)) < 0.1).all(axis=1) for z in PAPER]
    return loops.select(np.logical_or.reduce(near))


def diagnosed(loops: "Loops", seed: int) -> Answer:
    """Diagnose loops on the lumped base."""
    from sysid.diagnosis.diagnose import diagnose_loops

    begin = time.perf_counter()
    found = diagnose_loops(loops, models=(("lumped", "paper"),), seed=seed)
    return _answer(found, seed, time.perf_counter() - begin)


def _answer(found: "Diagnosis", seed: int, seconds: float) -> Answer:
    law = next((c for c in found.causes if LAW in c.members), None)
    screened = next(row for row in found.screen if row.id == LAW)
    size = (float("nan"), float("nan"), float("nan"))
    if law is not None and law.effect.facts.id == LAW:
        q = law.parameters[0]
        size = (q.value, q.low, q.high)
    gain = found.gain
    return Answer(
        seed=seed,
        excitations=len(np.unique(np.round(np.log(found.loops.amplitude), 1))),
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


def page(answers: Sequence[Answer]) -> Outcome:
    """Rates with their intervals, beside what is asked for."""
    outcome = Outcome("lumped_frequency", "BS09's puzzle: a law of frequency, hidden and found")
    outcome.say(*(__doc__ or "").split("\n\n", 1)[1].split("\n"))
    four, two = ([a for a in answers if a.excitations == n] for n in (4, 2))
    named = Share(sum(a.status == "named" for a in four), len(four))
    told = Share(sum(a.status in ("named", "class") for a in four), len(four))
    apart = Share(sum(a.inseparable for a in two), len(two))
    seen = Share(sum(a.found for a in two), len(two))
    wrong = Share(sum(a.status == "named" or bool(a.false_names) for a in two), len(two))
    false = Share(sum(bool(a.false_names) for a in four), len(four))
    known = [a for a in four if np.isfinite(a.size[0])]
    cover = Share(sum(a.size[1] <= PLANTED <= a.size[2] for a in known), len(known))
    rows = [
        ("four excitations: the law is named", named, "≥ 90 %"),
        ("named, or best of a class", told, ""),
        ("any other cause that is not there", false, ""),
        ("its interval holds the 5 % per decade", cover, ""),
        ("the paper's two: called inseparable from laws of speed", apart, "≥ 95 %"),
        ("asserted, as a class with these", seen, ""),
        ("the law, or anything that is not there, is named", wrong, "never"),
    ]
    outcome.table(("", "campaigns", "asked for"), rows)
    sizes = np.array([a.size[0] for a in known])
    if sizes.size:
        outcome.say(
            f"Identified: {100 * np.median(sizes):.2f} % per decade in the median, standard "
            f"deviation over campaigns {100 * sizes.std():.2f} %. Held-out error with four "
            f"excitations: {100 * np.mean([a.before for a in four]):.2f} % before, "
            f"{100 * np.nanmean([a.after for a in four]):.2f} % after."
        )
    dprime = [float(np.median([a.dprime for a in z])) for z in (four, two) if z]
    outcome.say(
        "The law over its standard error in the screen, d', with four and with two excitations: "
        f"{' and '.join(f'{z:.1f}' for z in dprime)} in the median."
    )
    outcome.say(f"Other causes that are not there: {_counts(answers)}.")
    outcome.numbers = {
        "named": named.as_dict(), "named_or_class": told.as_dict(), "false": false.as_dict(),
        "covered": cover.as_dict(), "inseparable": apart.as_dict(), "asserted": seen.as_dict(),
        "misnamed": wrong.as_dict(),
        "seconds": float(np.median([a.seconds for a in answers])),
    }  # fmt: skip
    return outcome


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
