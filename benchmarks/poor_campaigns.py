"""Do the tests that `sysid next` recommends settle what a poor campaign leaves open?

Campaigns of one frequency, of two excitations or of one current, one effect of realistic size
hidden in each.  Where the answer is a class that holds it, the recommended tests are run on the
same damper and everything is diagnosed anew; beside it as many tests drawn at random from those
allowed.  After two seeds of all effects only such campaigns go on that left something open.

Every finished campaign is one line of a work file, so that a study goes on where it was.
"""

import os
from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from outcome import RESULTS, Outcome
from study import run_study, study_parser
from work_file import FOLDER, read_rows

from sysid.jobs.job import Ended
from sysid.rig.planters.registry import CATALOGUE
from sysid.trials.program import TRIALS, fingerprint
from sysid.trials.proportions import Share

WORK: Final = RESULTS / "poor_campaigns.jsonl"
LEFT_OPEN: Final = 200
"""Campaigns that leave a class open, at which the study ends."""
FIRST_SEED: Final = 78_000
PROGRAM: Final = fingerprint((*TRIALS, "planning", "trials/poor.py"))
"""Rows count for the program that diagnosed and advised."""
EVERY: Final = 2
"""Seeds with which every effect is hidden in every kind of poor campaign; after them only in those
where one of these seeds left a class open."""
A_CLASS: Final = ("right_class", "vague_class")
"""First answers that leave a class open which holds the cause."""
QUICK: Final = ("one_frequency:78002:large_gas_chamber", "two_excitations:78001:late_sampling")


def main() -> None:
    parser = study_parser(__doc__ or "", "two campaigns")
    parser.add_argument("--left-open", type=int, default=LEFT_OPEN, help="campaigns that count")
    given = parser.parse_args()
    file = FOLDER / "poor_campaigns.quick.jsonl" if given.quick else WORK
    seed = FIRST_SEED
    while not given.page:
        names = QUICK if given.quick else block(seed, read_rows(file))
        run_study(names, work, file, PROGRAM, processes=given.processes, words=words)
        if given.quick or sum(bool(r["members"]) for r in read_rows(file)) >= given.left_open:
            break
        seed += 1
    make_page(read_rows(file)).finish(keep=not given.quick)


def block(seed: int, rows: Sequence[dict[str, Any]]) -> list[str]:
    """Names of the campaigns of one seed, in mixed order."""
    from sysid.trials.poor import POVERTIES

    kinds = [(poverty, p.name) for poverty in POVERTIES for p in CATALOGUE]
    if seed >= FIRST_SEED + EVERY:
        first = [r for r in rows if r["seed"] < FIRST_SEED + EVERY]
        left = {(r["poverty"], r["planter"]) for r in first if r["members"]}
        kinds = [k for k in kinds if k in left]
    names = [f"{poverty}:{seed}:{planter}" for poverty, planter in kinds]
    return [names[k] for k in np.random.default_rng(seed).permutation(len(names))]


def work(name: str) -> dict[str, Any]:
    """One campaign by its name."""
    from sysid.rig.planters.registry import find_planter
    from sysid.rig.trial_campaign import Trial
    from sysid.trials.one import diagnose_or_fail
    from sysid.trials.poor import run_poor

    poverty: Any
    poverty, seed, planter = name.split(":")

    def diagnose(trial: Trial) -> Any:
        return diagnose_or_fail(trial.loops, history=trial.history, seed=int(seed))

    row = run_poor(poverty, int(seed), find_planter(planter), diagnose)
    return {"id": name, **row.as_dict(), "program": PROGRAM}


def words(ended: Ended) -> str:
    """What became of a campaign, in a few words."""
    row: Any = ended.row
    if row["failure"]:
        return row["failure"]
    if not row["members"]:
        return row["before"] or "cannot be seen"
    after = row["after"]
    return f"{'/'.join(row['members'])}; {'; '.join(row['tests'])}; {after and after['left']}"


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Rates with their intervals."""
    page = Outcome("poor_campaigns", "What recommended tests settle")
    page.say(*(__doc__ or "").split("\n\n")[1].split("\n"))
    seen = [r for r in rows if r["detectable"] and (r["before"] or not r["failure"])]
    poor = [r for r in seen if r["bound"] < 0.95]
    left = [r for r in seen if r["members"] or (r["failure"] and r["before"] in A_CLASS)]
    ran = [r for r in left if r["after"]]
    page.say(
        f"{len(rows)} campaigns; in {len(seen)} something could be seen by anyone, and in",
        f"{len(poor)} of these nobody could name it with 95 % probability.",
    )
    page.table(
        ("first answer", "all", "nobody could name it"),
        [
            (verdict, sum(r["before"] == verdict for r in seen),
             sum(r["before"] == verdict for r in poor))
            for verdict, _ in Counter(r["before"] for r in seen).most_common()
        ],
    )  # fmt: skip
    right = Share(sum(r["after"]["right"] for r in ran), len(left))
    chance = Share(sum(r["by_chance"]["right"] for r in ran), len(left))
    # a failure leaves no tests behind, and may have come after them
    advised = sum(bool(r["tests"] or r["failure"]) for r in left)
    page.say("Campaigns whose answer is a class that holds the hidden cause:")
    page.table(
        ("", "the cause alone is left", "asked for"),
        [
            ("recommended tests", right, "≥ 90 %"),
            ("of these where there is one to recommend", Share(right.hits, advised), ""),
            ("as many at random", chance, ""),
        ],
    )
    hopeless = sum(r["hopeless"] for r in left)
    page.say(
        f"Tests: {sum(len(r['tests']) for r in ran) / max(len(ran), 1):.1f} a campaign. In",
        f"{hopeless} no test within the limits is said to tell the members apart; they count as",
        "not settled.",
    )
    page.say("What `sysid next` says of its tests, and what became of them:")
    page.table(
        ("it says", "the cause alone is left"),
        [
            (says, Share(sum(bool(r["after"] and r["after"]["right"]) for r in some), len(some)))
            for says, some in (
                ("these tests settle it", [r for r in left if r["promised"]]),
                ("they alone do not", [r for r in left if not r["promised"] and r["tests"]]),
                ("no test would", [r for r in left if r["hopeless"]]),
                ("nothing: it failed", [r for r in left if r["failure"]]),
            )
            if some or says != "nothing: it failed"
        ],
    )
    page.table(
        ("hidden", "left open", "said to settle it", "no test would", "settled", "at random"),
        [_line(cause, [r for r in left if r["cause"] == cause])
         for cause, _ in Counter(r["cause"] for r in left).most_common()],
    )  # fmt: skip
    page.table(
        ("campaign of", "left open", "said to settle it", "no test would", "settled", "at random"),
        [_line(poverty.replace("_", " "), [r for r in left if r["poverty"] == poverty])
         for poverty in sorted({r["poverty"] for r in left})],
    )  # fmt: skip
    failed = [r for r in rows if r["failure"]]
    if failed:
        page.say(
            f"{len(failed)} campaigns failed; those that had been left open before count as not",
            f"settled. The first: {failed[0]['failure']}",
        )
    page.numbers = {
        "campaigns": len(rows), "seen": len(seen), "left_open": len(left),
        "settled": right.as_dict(), "by_chance": chance.as_dict(), "hopeless": hopeless,
    }  # fmt: skip
    return page


def _line(name: str, some: Sequence[dict[str, Any]]) -> tuple[str, int, int, int, int, int]:
    """What became of some campaigns that were left open."""
    ran = [r for r in some if r["after"]]
    return (
        name, len(some), sum(r["promised"] for r in some), sum(r["hopeless"] for r in some),
        sum(r["after"]["right"] for r in ran), sum(r["by_chance"]["right"] for r in ran),
    )  # fmt: skip


if __name__ == "__main__":
    main()
