"""The text of a virtual campaign's `campaign.toml`."""


def manifest_text(title: str, name: str, limits: str) -> str:
    """What the columns mean, and what rig and damper allow.

    Args:
        title: Of the campaign.
        name: Pattern of the files' stems.
        limits: Lines of the table [limits].
    """
    return f"""\
[campaign]
name = "{title}"
positive_force = "compression"
positive_displacement = "compression"

[files]
folder = "."
glob = "*.csv"
name = "{name}"

[columns]
time = {{ column = "time_s", unit = "s" }}
displacement = {{ column = "displacement_mm", unit = "mm" }}
force = {{ column = "force_N", unit = "N" }}
current = {{ column = "current_A", unit = "A" }}
temperature = {{ column = "temperature_degC", unit = "degC" }}

[limits]
{limits}
"""
