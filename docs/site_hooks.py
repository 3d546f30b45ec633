"""What the documentation site has beside the pages of this folder: measured results, and the API.

The pages are written to be read in the repository. On the site, a link that leaves `docs/` leads to
the copy of a page of `benchmarks/results`, and where it leads to code it becomes the code's path.
"""

import ast
import posixpath
import re
from pathlib import Path
from typing import Any, Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT: Final = Path(__file__).resolve().parents[1]
RESULTS: Final = ROOT / "benchmarks" / "results"
LINK: Final = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")

API: Final[dict[str, tuple[str, str]]] = {
    "data": ("Data", "Files to records, records to steady loops, and what is wrong with them."),
    "parameters": ("Parameters", "Declarations of parameters."),
    "effects": ("Effects", "What an effect is, and the catalogue."),
    "models": ("Models", "Dampers and their parts."),
    "motion": ("Motion", "What a damper is subjected to."),
    "likelihood": ("Likelihood", "How probable loops are under a model."),
    "identification": ("Identification", "Fits without start values."),
    "fleet": ("Fleet", "Thousands of dampers in one batched fit."),
    "uncertainty": ("Uncertainty", "Intervals, posterior, bands."),
    "diagnosis": ("Diagnosis", "What a model gets wrong, and why."),
    "planning": ("Planning", "The next test."),
    "cards": ("Cards", "The file that simulators read."),
    "report": ("Report", "One plot a function, and the page."),
    "isolator": ("Isolator", "What a damper does in a vibration isolator."),
    "rig": ("Rig", "The virtual laboratory."),
    "trials": ("Trials", "Blind trials."),
    "jobs": ("Jobs", "Work on many workers."),
    "errors": ("Errors", "What can go wrong with input."),
    "units": ("Units", "Symbols of units and SI."),
}
"""Package or module of `sysid` → title and a sentence."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Append the pages made here to the navigation."""
    results = [{_heading(path): f"results/{path.name}"} for path in sorted(RESULTS.glob("*.md"))]
    api = [{title: f"api/{name}.md"} for name, (title, _) in API.items()]
    config.nav = [*(config.nav or []), {"API": api}, {"Measured results": results}]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add results and API pages to the files of the site."""
    for path in sorted([*RESULTS.glob("*.md"), *RESULTS.glob("*.png")]):
        files.append(File.generated(config, f"results/{path.name}", abs_src_path=str(path)))
    for name in API:
        files.append(File.generated(config, f"api/{name}.md", content=_api_page(name)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links that leave `docs/` to what the site has instead."""
    here = posixpath.dirname(page.file.src_uri)

    def turned(match: re.Match[str]) -> str:
        mark, text, target = match.groups()
        if "://" in target or target.startswith(("#", "mailto:")):
            return match[0]
        path, _, anchor = target.partition("#")
        place = posixpath.normpath(posixpath.join("docs", here, path))
        if place.startswith("docs/") or here in ("results", "api"):
            return match[0]
        if not (ROOT / place).exists():
            return match[0]  # mkdocs will say that it is missing
        if place.startswith("benchmarks/results/"):
            made = posixpath.relpath(place.removeprefix("benchmarks/"), here or ".")
            return f"{mark}[{text}]({made}{'#' + anchor if anchor else ''})"
        return f"{text} (`{place}`)"

    return LINK.sub(turned, markdown)


def _heading(path: Path) -> str:
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            return line[2:].strip()
    return path.stem


def _api_page(name: str) -> str:
    title, sentence = API[name]
    folder = ROOT / "sysid" / name
    if not folder.is_dir():
        return f"# {title}\n\n{sentence}\n\n::: sysid.{name}\n"
    modules = [p for p in sorted(folder.rglob("*.py")) if _has_public(p)]
    blocks = [f"::: {_dotted(path)}" for path in modules]
    return f"# {title}\n\n{sentence}\n\n" + "\n\n".join(blocks) + "\n"


def _dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _has_public(path: Path) -> bool:
    """Whether a module defines a public class or function that has a docstring."""
    if path.name == "__init__.py":
        return False
    tree: Any = ast.parse(path.read_text(encoding="utf-8"))
    return any(
        isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")
        for node in tree.body
    )
