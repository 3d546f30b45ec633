"""What the recipes are wrong by, test by test, and readings without it."""

from dataclasses import dataclass, replace

from sysid.identification.straight_lines.stage import Reading


@dataclass(frozen=True)
class Bias:
    """Recipe over truth minus one, test by test, dimensionless.

    Attributes:
        viscosity: Id → of C_post.
        yield_force: Id → of F_y, dimensionless.
        stiffness: Id → of k, dimensionless.
    """

    viscosity: dict[str, float]
    yield_force: dict[str, float]
    stiffness: dict[str, float]


def without(readings: tuple[Reading, ...], bias: dict[str, float]) -> tuple[Reading, ...]:
    """Readings with a bias divided out; those whose bias is not known are left away."""
    kept = []
    for r in readings:
        if r.id in bias:
            by = 1.0 + bias[r.id]
            kept.append(
                replace(
                    r, value=r.value / by, se=r.se / by, half_difference=r.half_difference / by,
                    choices=r.choices / by,
                )
            )  # fmt: skip
    return tuple(kept)
