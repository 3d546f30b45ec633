"""W11's own puzzle: one card for the 2.5 mm and the 12.5 mm tests, which W11 fitted separately."""

import argparse
import io
import time
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from outcome import Outcome

if TYPE_CHECKING:
    from sysid.data.loops import Loops
    from sysid.diagnosis.bases import Base
    from sysid.diagnosis.result import Diagnosis

ROOT: Final = Path(__file__).resolve().parents[1]
SETS: Final = ("virtual-w11-low", "virtual-w11-high")
MODEL: Final = ("generalized", "symmetric")
ALONE: Final = ("width_law", "series_compliance", "backlash", "force_delay", "frequency_law")
"""Effects that are tried alone, beside the diagnosis: what else might have made two sets needed."""


def main() -> None:
    from sysid.diagnosis.diagnose import diagnose_loops

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all-bases", action="store_true", help="not W11's model alone: minutes")
    parser.add_argument("--quick", action="store_true", help="nothing written")
    given = parser.parse_args()
    begin = time.perf_counter()

    def say(line: str) -> None:
        print(f"{time.perf_counter() - begin:6.0f} s  {line}", flush=True)

    sets = [measured(name) for name in SETS]
    loops = joined(*sets)
    separate = [base_of(one) for one in sets]
    found = diagnose_loops(loops, models=None if given.all_bases else (MODEL,), progress=say)
    outcome = page(sets, separate, found, alone(base_of(loops)))
    outcome.numbers["seconds"] = time.perf_counter() - begin
    outcome.finish(keep=not given.quick)
    if not given.quick:
        figure = Path(__file__).parent / "results" / "w11_joined.png"
        figure.write_bytes(loops_png(found))


def measured(name: str) -> "Loops":
    """Steady loops of a shipped dataset."""
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign

    return select(load_campaign(ROOT / "datasets" / name), (), ()).loops


def joined(first: "Loops", second: "Loops") -> "Loops":
    """The tests of two campaigns as one."""
    values = {}
    for field in fields(first):
        a, b = getattr(first, field.name), getattr(second, field.name)
        values[field.name] = (*a, *b) if isinstance(a, tuple) else np.concatenate([a, b])
    return type(first)(**values)


def base_of(loops: "Loops") -> "Base":
    """W11's symmetric model, fitted; every condition also predicted without it."""
    from sysid.diagnosis.bases import fit_bases

    return fit_bases(loops, (MODEL,), seed=0, progress=lambda _: None)[0]


def alone(base: "Base") -> dict[str, float]:
    """Held-out error of the base with one effect, in the form that scores best."""
    from sysid.diagnosis.contenders import score_candidates, start_with, with_effect
    from sysid.diagnosis.held_out import leave_conditions_out
    from sysid.diagnosis.plain import plainly_fitted, unweighted
    from sysid.diagnosis.prototypes import prototypes
    from sysid.effects.registry import choices

    evidence = unweighted(base.evidence)
    candidates = [e for e in prototypes(evidence.size) if e.facts.id in ALONE]
    errors = {}
    for scored in score_candidates(evidence, base.free, candidates):
        extended = with_effect(base.free.coordinates, scored.effect)
        start = start_with(base.free, extended, scored)
        state = plainly_fitted(evidence, extended, start)
        form = [getattr(scored.effect, key) for key in choices(type(scored.effect))[0]]
        name = ", ".join([scored.effect.facts.id, *map(str, form)])
        errors[name] = float(leave_conditions_out(evidence, state).mean())
    return dict(sorted(errors.items(), key=lambda item: item[1]))


def travel_to_zero(force: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Travel from the reversal at the largest displacement to zero force, [L] m."""
    found = []
    for F, x in zip(force, displacement, strict=True):
        start = int(np.argmax(x))
        after, travel = np.roll(F, -start), x.max() - np.roll(x, -start)
        k = max(int(np.argmax(after < 0.0)), 1)
        found.append(np.interp(0.0, [-after[k - 1], -after[k]], [travel[k - 1], travel[k]]))
    return np.array(found)


def page(
    sets: "list[Loops]", separate: "list[Base]", found: "Diagnosis", others: dict[str, float]
) -> Outcome:
    """Errors of two models, of one, and of the extended one; and the travel that tells why."""
    outcome = Outcome("w11_joined", "W11's two sets of tests as one campaign")
    outcome.say(
        "20 tests of 12.5 mm (0.5 to 5 Hz) and 25 of 2.5 mm (5 to 15 Hz), 0 to 0.4 A, made from "
        "the two columns of W11's Table 2 with noise: `datasets/virtual-w11-low` and `-high`. "
        "Errors are mean RMSE/max|F| over tests, every condition predicted without it."
    )
    gain = found.gain
    before, after = found.simulated_before, found.simulated_after
    low = np.arange(len(found.loops.ids)) < len(sets[0].ids)
    rows = [
        ("two models, each fitted to its own set", *_by_set(_held(separate), low)),
        ("each of these two on the other set", *_by_set(np.concatenate(crossed(separate)), low)),
    ]
    if gain is not None:
        effects = ", ".join(e.facts.id for e in found.damper.effects)
        rows += [
            ("one model", *_by_set(gain.per_test_before, low)),
            (f"one model with {effects}", *_by_set(gain.per_test_after, low)),
        ]
    outcome.table(("", "12.5 mm", "2.5 mm", "all"), rows)
    outcome.say(
        "On tests made from two published columns the two models are the truth itself, each on its "
        "own set: one model with one effect does not reach them. No one of the two serves both. "
        "What one model cannot repeat, and how many parameters it would take: "
        "[w11_rest](w11_rest.md)."
    )
    outcome.say(f"Answer: {found.answer}.", *found.sentences)
    outcome.say("One model with one effect alone, joined tests, in the form that scores best:")
    outcome.table(("effect", "held out"), [(k, _percent(v)) for k, v in others.items()])
    outcome.say(
        "Travel from reversal to zero force, mm: mean (range) over the frequencies of a set. "
        "Beside it the force at the reversal, N: on a linear spring the travel grows with it."
    )
    outcome.table(("current", "", "measured", "one model", "extended", "force at reversal"),
                  _travels(found, before, after, low))  # fmt: skip
    outcome.numbers = {
        "answer": found.answer,
        "sentences": found.sentences,
        "effects": [e.facts.id for e in found.damper.effects],
        "before": gain and gain.before,
        "after": gain and gain.after,
        "two_models": [b.error for b in separate],
        "crossed": [float(z.mean()) for z in crossed(separate)],
        "alone": others,
    }
    return outcome


def _held(separate: "list[Base]") -> np.ndarray:
    return np.concatenate([base.held_out for base in separate])


def crossed(separate: "list[Base]") -> list[np.ndarray]:
    """Errors of the tests of each set by the model of the other."""
    import jax.numpy as jnp

    from sysid.models.coordinates import valve_at

    dampers = [valve_at(b.free.coordinates, jnp.asarray(b.free.u)) for b in separate]
    return [b.evidence.errors(d) for b, d in zip(separate, dampers[::-1], strict=True)]


def _by_set(errors: np.ndarray, low: np.ndarray) -> tuple[str, str, str]:
    return _percent(errors[low].mean()), _percent(errors[~low].mean()), _percent(errors.mean())


def _travels(
    found: "Diagnosis", before: np.ndarray, after: np.ndarray, low: np.ndarray
) -> list[tuple[str, ...]]:
    loops = found.loops
    travel = [1e3 * travel_to_zero(F, loops.displacement) for F in (loops.force, before, after)]
    turning = np.argmax(loops.displacement, axis=1)
    reversal = loops.force[np.arange(turning.size), turning]
    set_current = np.round(loops.current, 1)
    rows = []
    for current in np.unique(set_current):
        for name, which in (("12.5 mm", low), ("2.5 mm", ~low)):
            here = which & (set_current == current)
            spans = [f"{t[here].mean():.3f} ({np.ptp(t[here]):.3f})" for t in travel]
            forces = f"{reversal[here].min():.0f} … {reversal[here].max():.0f}"
            rows.append((f"{current:g} A", name, *spans, forces))
    return rows


def loops_png(found: "Diagnosis") -> bytes:
    """Loops of both sets over displacement and after the reversal, before and after."""
    from matplotlib.figure import Figure

    loops = found.loops
    figure = Figure(figsize=(15.0, 8.5), layout="constrained")
    grid = figure.subplots(2, 4, squeeze=False)
    places = [(a, f) for a, f in ((12.5e-3, 0.5), (12.5e-3, 5.0), (2.5e-3, 5.0), (2.5e-3, 15.0))]
    curves = ((loops.force, "0.7", 4.0, "-", "measured"),
              (found.simulated_before, "#D55E00", 1.3, "--", "one model"),
              (found.simulated_after, "#0072B2", 1.3, "-", "extended"))  # fmt: skip
    for column, (amplitude, frequency) in enumerate(places):
        distance = np.abs(np.log(loops.amplitude / amplitude)) + np.abs(
            np.log(loops.frequency / frequency)
        )
        tests = np.flatnonzero(distance < distance.min() + 0.05)
        whole, start = grid[0][column], grid[1][column]
        for k in tests[np.isin(np.round(loops.current[tests], 1), (0.0, 0.1, 0.3))]:
            x = 1e3 * loops.displacement[k]
            turn = int(np.argmax(x))
            travel = x.max() - np.roll(x, -turn)
            first = slice(0, max(int(np.argmax(travel > 1.2)), 2))
            for force, color, width, dash, label in curves:
                style = {"color": color, "linewidth": width, "linestyle": dash, "label": label}
                whole.plot(np.append(x, x[0]), np.append(force[k], force[k][0]), **style)
                start.plot(travel[first], np.roll(force[k], -turn)[first], **style)
        whole.set_title(f"{1e3 * amplitude:g} mm, {frequency:g} Hz; 0, 0.1 and 0.3 A", fontsize=10)
        whole.set_xlabel("displacement / mm")
        start.set_xlabel("travel since the reversal / mm")
        start.axhline(0.0, color="black", linewidth=0.8)
        for ax in (whole, start):
            ax.set_ylabel("force / N")
            ax.grid(alpha=0.3)
    handles, labels = grid[0][0].get_legend_handles_labels()
    grid[0][0].legend(handles[:3], labels[:3], fontsize=8, loc="center")
    target = io.BytesIO()
    figure.savefig(target, format="png", dpi=80)
    return target.getvalue()


def _percent(value: float) -> str:
    return f"{100 * value:.2f} %"


if __name__ == "__main__":
    main()
