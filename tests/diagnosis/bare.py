"""Results with no more in them than a test looks at."""

from typing import TypeVar

T = TypeVar("T")


def bare(kind: type[T], **fields: object) -> T:
    """An object with no more than what is looked at."""
    one = object.__new__(kind)
    for name, value in fields.items():
        object.__setattr__(one, name, value)
    return one
