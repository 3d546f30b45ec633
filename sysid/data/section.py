"""Building blocks of `campaign.toml`: a table that knows its keys, and a number with its unit."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from sysid.units import find_unit, to_si

Finite = Annotated[float, Field(allow_inf_nan=False)]
Text = Annotated[str, Field(min_length=1)]


class Section(BaseModel):
    """A table of the manifest: keys that it does not know are refused, and nothing is guessed."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Amount(Section):
    """A number with its unit.

    Attributes:
        value: In `unit`.
        unit: Its symbol.
    """

    value: Finite
    unit: Text

    def si(self, quantity: str) -> float:
        """The number in SI (temperatures in °C).

        Args:
            quantity: What it is, one of `sysid.units.SI_SYMBOL`'s keys.

        Raises:
            UnitError: The unit is not known, or is one of another quantity.
        """
        return float(to_si(self.value, find_unit(self.unit, quantity)))


class UncertainAmount(Amount):
    """A number with its unit and standard deviation.

    Attributes:
        sd: In the same unit, a difference.
    """

    sd: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None = None
