"""Cards of W11's low set, with and without effects, made without any fit."""

from functools import cache

import numpy as np

from sysid.cards.check import check_vectors
from sysid.cards.schema import (
    SCHEMA,
    Card,
    Covariance,
    Damper,
    DataFile,
    Effect,
    Parameter,
    Quality,
    Validity,
)  # fmt: skip
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choices
from sysid.models.damper import Damper as Model
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import as_dict, build, specs


@cache
def example_card() -> Card:
    return card_with()


def card_with(*effects: AbstractEffect) -> Card:
    damper = Model(build(Generalized, LOW_SYMMETRIC), effects)
    validity = Validity(
        amplitude=(0.0125, 0.0125),
        frequency=(0.5, 5.0),
        velocity=(0.0, 0.393),
        current=(0.0, 0.4),
        temperature=(30.0, 50.0),
        centre=0.0,
    )
    free = tuple(spec.symbol for spec in specs(Generalized)[:3])
    root = np.array([[0.4, 0.0, 0.0], [0.01, 0.02, 0.0], [0.02, 0.01, 0.05]])
    return Card(
        format=SCHEMA,
        software="sysid 0.1.0",
        model="generalized",
        variant="symmetric",
        weights="paper",
        damper=Damper(name="example", campaign="example"),
        parameters=tuple(
            Parameter(
                symbol=s.symbol, name=s.name, value=LOW_SYMMETRIC[s.symbol], unit=s.unit,
                sd=None, low=None, high=None, identified=True,
            )
            for s in specs(Generalized)
        ),
        effects=tuple(effect_entry(e) for e in effects),
        covariance=Covariance(symbols=free, matrix=tuple(map(tuple, (root @ root.T).tolist()))),
        posterior=None,
        interval="0.95, sandwich over conditions",
        validity=validity,
        quality=Quality(mean_nrmse=0.011, held_out_mean_nrmse=None, noise_floor_nrmse=0.01),
        known_discrepancies=("The list [ 1, 2 ] stays as it is.",),
        data=(DataFile(file="12.5mm_1.5Hz_0.2A.csv", sha256="0" * 64),),
        check=check_vectors(damper, validity),
    )  # fmt: skip


def effect_entry(effect: AbstractEffect) -> Effect:
    values = as_dict(effect)
    return Effect(
        id=effect.facts.id,
        stage=effect.stage,
        choice={key: getattr(effect, key) for key in choices(type(effect))[0]},
        parameters=tuple(
            Parameter(
                symbol=f"{effect.facts.id}.{s.symbol}", name=s.name, value=values[s.symbol],
                unit=s.unit, sd=None, low=None, high=None, identified=True,
            )
            for s in specs(effect)
        ),
    )  # fmt: skip
