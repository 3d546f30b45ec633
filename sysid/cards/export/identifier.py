"""Names and comments that any C compiler accepts."""

import keyword
import re
import textwrap
from typing import Final

_PLAIN: Final = str.maketrans(
    {
        "·": "*", "²": "2", "³": "3", "°": "deg ", "–": "-", "—": "-", "−": "-", "′": "'",
        "σ": "sigma", "ω": "omega", "≤": "<=", "≥": ">=", "±": "+-", "×": "x", "…": "...",
        "ẍ": "x''", "Σ": "Sigma",
    }
)  # fmt: skip
_C_WORDS: Final = """
auto break case char const continue default do double else enum extern float for goto if inline int
long main register restrict return short signed sizeof static struct switch typedef union unsigned
void volatile while
"""


def identifier(text: str) -> str:
    """A name for files and functions made of any text: letters, digits and underscores."""
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower()
    if not name or name[0].isdigit():
        name = f"damper_{name}".rstrip("_")
    return f"{name}_" if name in _C_WORDS.split() or keyword.iskeyword(name) else name


def ascii_text(text: str) -> str:
    """Text without letters that a compiler might not know, and without the end of a comment."""
    plain = text.translate(_PLAIN).encode("ascii", "replace").decode()
    return plain.replace("*/", "* /").replace("\\", "/").replace('"', "'").replace("\n", " ")


def comment(text: str, *, inside: bool = False) -> str:
    """Text as a comment of lines that fit; `inside` of one that has begun."""
    lines = textwrap.wrap(ascii_text(text), 94)
    body = "\n".join(f" * {line}" for line in lines)
    return f"{body}\n" if inside else f"/*{body[2:]} */\n"
