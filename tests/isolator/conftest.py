import jax.numpy as jnp
import numpy as np
import pytest

from sysid.cards.check import check_vectors
from sysid.cards.schema import Card, Covariance, Parameter, Validity
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
from sysid.parameters import as_dict, build, specs
from tests.cards.example import effect_entry, example_card
from tests.cards.export.dampers import valve as valve_of


def lumped_card(*effects, numbers=TABLE_1, checked=False) -> Card:
    """A card of BS09's damper, 2 % uncertain; check vectors take seconds."""
    valve = build(Lumped, numbers)
    validity = Validity(
        amplitude=(0.005, 0.01),
        frequency=(4.0, 8.0),
        velocity=(0.0, 0.503),
        current=(0.0, 1.0),
        temperature=(15.0, 75.0),
        centre=0.0,
    )
    free = [s.symbol for s in specs(valve) if s.symbol not in ("C_pre", "m_l", "tau")]
    variance = np.diag([(0.02 * numbers[s]) ** 2 for s in free])
    return example_card().model_copy(
        update={
            "model": "lumped",
            "variant": "paper",
            "parameters": tuple(
                Parameter(
                    symbol=s.symbol, name=s.name, value=numbers[s.symbol], unit=s.unit,
                    sd=None, low=None, high=None, identified=True,
                )
                for s in specs(valve)
            ),
            "effects": tuple(effect_entry(e) for e in effects),
            "covariance": Covariance(
                symbols=tuple(free), matrix=tuple(map(tuple, variance.tolist()))
            ),
            "validity": validity,
            "check": check_vectors(Damper(valve, effects), validity) if checked else (),
        }
    )  # fmt: skip


@pytest.fixture(scope="session")
def valve() -> Lumped:
    return build(Lumped, TABLE_1)


@pytest.fixture(scope="session")
def number():
    return lambda z: jnp.asarray(float(z))


def card_of(model: str, *effects) -> Card:
    """A card of any model, at the numbers of the exported dampers, without check vectors."""
    known = as_dict(valve_of(model))
    parameters = tuple(
        Parameter(
            symbol=s.symbol, name=s.name, value=known[s.symbol], unit=s.unit,
            sd=None, low=None, high=None, identified=True,
        )
        for s in specs(valve_of(model))
    )  # fmt: skip
    changed = {"model": model, "parameters": parameters, "check": ()}
    return example_card().model_copy(
        update=changed | {"effects": tuple(map(effect_entry, effects))}
    )
