"""README and documentation pages, and the fenced blocks in them."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = (ROOT / "README.md", *sorted(DOCS.rglob("*.md")))
_FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced block: its page, its language ("" for commands and drawings), its lines."""

    page: Path
    language: str
    text: str

    @property
    def name(self) -> str:
        """For test ids."""
        return f"{self.page.stem}: {self.text.strip().splitlines()[0][:40]}"


def blocks() -> tuple[Block, ...]:
    return tuple(
        Block(page, match[1].strip(), match[2])
        for page in PAGES
        for match in _FENCE.finditer(page.read_text(encoding="utf-8"))
    )


def commands(block: Block) -> list[str]:
    """The commands of a block, one each; lines joined, what stands behind && apart."""
    lines = block.text.replace("\\\n", " ").splitlines()
    calls = [part.strip() for line in lines for part in line.split("&&")]
    return [call.replace(".venv/bin/", "") for call in calls if call]
