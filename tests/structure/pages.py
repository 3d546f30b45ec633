"""README and documentation pages, and the fenced blocks in them."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = (ROOT / "README.md", *sorted(DOCS.rglob("*.md")))
_FENCE = re.compile(
    r"^(?:<!-- long: ([^\n]*) -->\n\n)?```([^\n]*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE
)


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes:
        page: Where it stands.
        language: "" for commands and drawings.
        text: Its lines.
        long: Why it is only taken apart, from the comment `<!-- long: … -->` above it; else "".
    """

    page: Path
    language: str
    text: str
    long: str

    @property
    def name(self) -> str:
        """For test ids."""
        return f"{self.page.stem}: {self.text.strip().splitlines()[0][:40]}"


def blocks() -> tuple[Block, ...]:
    return tuple(
        Block(page, match[2].strip(), match[3], match[1] or "")
        for page in PAGES
        for match in _FENCE.finditer(page.read_text(encoding="utf-8"))
    )


def commands(block: Block) -> list[str]:
    """The commands of a block, one each; lines joined, what stands behind && apart."""
    lines = block.text.replace("\\\n", " ").splitlines()
    calls = [part.strip() for line in lines for part in line.split("&&")]
    return [call.replace(".venv/bin/", "") for call in calls if call]
