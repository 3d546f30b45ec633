"""One sentence for what holds of many files: else a folder of them hides every other remark."""

from collections.abc import Iterable
from typing import Final

_SHOWN: Final = 3


def pooled(remarks: Iterable[tuple[str, str]], what: str) -> list[str]:
    """Sentences, each once, with those of whom it is said.

    Args:
        remarks: Of whom, and the sentence; the same may come twice.
        what: A word for several of them.
    """
    of: dict[str, dict[str, None]] = {}
    for who, sentence in remarks:
        of.setdefault(sentence, {})[who] = None
    return [f"{_those(list(who), what)}: {sentence}" for sentence, who in of.items()]


def _those(who: list[str], what: str) -> str:
    if len(who) == 1:
        return who[0]
    more = ", …" if len(who) > _SHOWN else ""
    return f"{len(who)} {what} ({', '.join(who[:_SHOWN])}{more})"
