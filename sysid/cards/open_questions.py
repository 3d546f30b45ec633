"""`open.json`: what a diagnosis left open, written beside its card and read by `sysid next`."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, NoReturn

import jax.numpy as jnp
import numpy as np
from pydantic import ValidationError

from sysid.cards import open_schema as schema
from sysid.cards.models import MODELS
from sysid.data.loops import Loops
from sysid.data.manifest import Amount, Manifest
from sysid.diagnosis.questions import Alternative, Open, Question, Told
from sysid.diagnosis.result import Diagnosis
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choice_of, effect_kind
from sysid.errors import CardError
from sysid.likelihood.discrepancy import Sizes
from sysid.models.damper import Damper
from sysid.parameters import as_dict, build
from sysid.planning.limits import Conditions, Limits, limits_within

FILE: Final = "open.json"
AGAIN: Final = "Run `sysid diagnose` again"


@dataclass(frozen=True)
class OpenCase:
    """What `sysid next` goes by.

    Attributes:
        answer: Of the diagnosis.
        asked: What is open.
        limits: Of rig and damper.
        temperature: °C of the tests, median; NaN if unknown.
    """

    answer: str
    asked: Open
    limits: Limits
    temperature: float


def open_file(asked: Open, diagnosis: Diagnosis, manifest: Manifest) -> schema.OpenFile:
    """What is open as a file.

    Args:
        asked: What is open.
        diagnosis: That left it.
        manifest: With the limits of rig and damper.
    """
    every = list({id(a): a for q in asked.questions for a in q.alternatives}.values())
    numbers = {id(a): k for k, a in enumerate(every)}
    questions = tuple(
        schema.OpenQuestion(
            kind=q.kind, about=q.about, alternatives=tuple(numbers[id(a)] for a in q.alternatives)
        )
        for q in asked.questions
    )
    return schema.OpenFile(
        format=schema.SCHEMA,
        answer=diagnosis.answer,
        model=diagnosis.fit.model,
        errors=schema.OpenErrors(noise_N=asked.noise, sizes=asdict(asked.sizes)),
        conditions=_conditions(diagnosis.loops),
        limits=_limits(manifest),
        alternatives=tuple(_alternative(a) for a in every),
        questions=questions,
        told=tuple(schema.OpenTold(about=t.about, test=t.test) for t in asked.told),
    )


def _conditions(loops: Loops) -> schema.OpenConditions:
    def ends(z: np.ndarray) -> tuple[float, float]:
        return float(z.min()), float(z.max())

    warm = loops.temperature[np.isfinite(loops.temperature)]
    levels = np.unique(np.round(np.abs(loops.current), 3))
    return schema.OpenConditions(
        amplitude_m=ends(loops.amplitude),
        frequency_Hz=ends(loops.frequency),
        current_A=tuple(levels.tolist()),
        temperature_degC=float(np.median(warm)) if warm.size else None,
        displacement_m=float(np.abs(loops.displacement).max()),
        speed_m_s=float(loops.peak_velocity.max()),
        force_N=float(np.abs(loops.force).max()),
    )


def _limits(manifest: Manifest) -> schema.OpenLimits:
    given = manifest.limits

    def si(amount: Amount | None, quantity: str) -> float | None:
        return None if amount is None else amount.si(quantity)

    return schema.OpenLimits(
        stroke_m=si(given.stroke, "displacement"),
        velocity_m_s=si(given.velocity, "velocity"),
        current_A=si(given.current, "current"),
        frequency_Hz=si(given.frequency, "frequency"),
        force_N=si(given.force, "force"),
    )


def _alternative(one: Alternative) -> schema.OpenAlternative:
    return schema.OpenAlternative(
        ids=one.ids,
        parameters=as_dict(one.damper.valve),
        effects=tuple(
            schema.OpenEffect(
                id=e.facts.id,
                choice=dict(choice_of(e)),
                parameters=as_dict(e),
            )
            for e in one.damper.effects
        ),
        symbols=one.symbols,
        ties=one.ties,
        covariance=tuple(tuple(row) for row in one.covariance.tolist()),
    )


def open_text(file: schema.OpenFile) -> str:
    """Its JSON."""
    return json.dumps(file.model_dump(mode="json", by_alias=True), allow_nan=False) + "\n"


def read_open(folder: Path) -> OpenCase:
    """Read what a diagnosis left open.

    Args:
        folder: That `sysid diagnose` wrote.

    Raises:
        CardError: There is no such file, or it is not what `sysid diagnose` writes.
    """
    path = folder / FILE
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as cause:
        raise CardError(
            "is no folder of a diagnosis that can be taken further"
            if folder.is_dir()
            else "is no folder",
            where=folder,
            advice=f"Give the folder of `sysid diagnose CAMPAIGN -o DIR`, with its {FILE}",
        ) from cause
    try:
        file = schema.OpenFile.model_validate_json(text, by_alias=True, by_name=False)
    except ValidationError as cause:
        first = cause.errors()[0]
        place = ".".join(map(str, first["loc"])) or "its form"
        raise CardError(f"{place}: {first['msg']}", where=path, advice=AGAIN) from cause
    return _case(file, path)


def _case(file: schema.OpenFile, path: Path) -> OpenCase:
    try:
        every = [_read(one, file.model) for one in file.alternatives]
        questions = tuple(
            Question(q.kind, q.about, tuple(every[k] for k in q.alternatives))
            for q in file.questions
        )
        told = tuple(Told(t.about, t.test) for t in file.told)
        asked = Open(questions, told, Sizes(**file.errors.sizes), file.errors.noise_N)
    except (KeyError, ValueError, TypeError, IndexError) as cause:
        _refuse(path, cause)
    done, given = file.conditions, file.limits
    warm = done.temperature_degC
    conditions = Conditions(
        done.amplitude_m, done.frequency_Hz, done.current_A, math.nan if warm is None else warm,
        done.displacement_m, done.speed_m_s, math.nan if done.force_N is None else done.force_N,
    )  # fmt: skip
    limits = limits_within(
        conditions,
        stroke=None if given.stroke_m is None else 0.5 * given.stroke_m,
        velocity=given.velocity_m_s,
        current=given.current_A,
        frequency=given.frequency_Hz,
        force=math.inf if given.force_N is None else given.force_N,
    )
    return OpenCase(file.answer, asked, limits, conditions.temperature)


def _refuse(path: Path, cause: Exception) -> NoReturn:
    raise CardError(
        f"does not fit together ({cause!s})", where=path, advice=f"It was altered by hand. {AGAIN}"
    ) from cause


def _read(one: schema.OpenAlternative, model: str) -> Alternative:
    k = len(one.symbols)
    covariance = np.array(one.covariance, dtype=float).reshape(k, k)
    damper = Damper(build(MODELS[model], one.parameters), tuple(map(_effect, one.effects)))
    return Alternative(one.ids, damper, one.symbols, one.ties, covariance)


def _effect(one: schema.OpenEffect) -> AbstractEffect:
    kind = effect_kind(one.id)
    values: Mapping[str, object] = {s: jnp.asarray(v) for s, v in one.parameters.items()}
    return kind(**values, **one.choice)
