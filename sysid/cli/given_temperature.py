"""A temperature that nobody recorded: how sure it is, told and not counted in any interval."""

from collections import Counter
from collections.abc import Sequence

from sysid.data.figures import figure
from sysid.data.record import Record


def told_of_temperature(records: Sequence[Record]) -> tuple[str, ...]:
    """One sentence where campaign.toml gives tests a temperature with a standard deviation.

    Args:
        records: Tests of the campaign.
    """
    given = Counter(
        (record.nominal.temperature, record.nominal.temperature_sd)
        for record in records
        if record.temperature is None and record.nominal.temperature_sd
    )
    return tuple(
        f"The temperature of {count} of {len(records)} tests was not recorded; campaign.toml gives "
        f"{figure(mean or 0.0)} °C with a standard deviation of {figure(sd or 0.0)} K. Fits take "
        "it as it is: no interval and no range of validity counts that deviation."
        for (mean, sd), count in given.items()
    )
