"""How long report.html takes in a browser, from opening the file: first screen, figures, a click.

    python benchmarks/report_time.py                  a page of 165 tests with two models
    python benchmarks/report_time.py a.html b.html    pages that are there, in turns; printed only
    python benchmarks/report_time.py --often 5

Needs a Chromium; SYSID_CHROMIUM names one that is not on the path.  Every page is opened in a fresh
browser each time, the pages in turns, and medians are told: what else the machine does moves them.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from outcome import Outcome

from sysid.report.page.render import render
from tests.report.browser import Tab, find_browser, in_browser
from tests.report.made_page import many_page

CLICK = """(() => {
  const from = performance.now();
  document.querySelectorAll("#matrix button.cell")[60].click();
  document.getElementById("detail-velocity").getBoundingClientRect();
  return performance.now() - from;
})()"""
STEPS = {
    "painted": "something is to be seen",
    "first": "verdict, bars and the worst test's loops are there, and clicks are heard",
    "loops": "the chosen test is drawn, in plain lines until the library is there",
    "all": "every figure is drawn",
    "click": "from a click on a cell to its loops, then",
}


async def _times(tab: Tab) -> dict[str, float]:
    """When each step was done, ms after the file was opened."""
    await tab.until("document.documentElement?.dataset.ready")
    told = await tab.run("({...document.documentElement.dataset})")
    paint = await tab.run("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    return {
        "painted": float(paint), "first": float(told["first"]),
        "loops": float(told.get("loops", "nan")), "all": float(told["ready"]),
        "click": float(await tab.run(CLICK)),
    }  # fmt: skip


def main() -> None:
    """Open pages and print medians."""
    parser = argparse.ArgumentParser(description="How long report.html takes in a browser.")
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--often", type=int, default=5)
    asked = parser.parse_args()
    if find_browser() is None:
        sys.exit("No Chromium on this machine: name one with SYSID_CHROMIUM.")
    with tempfile.TemporaryDirectory() as scratch:
        pages = asked.pages
        if not pages:
            pages = [Path(scratch) / "165 tests.html"]
            pages[0].write_bytes(render(many_page()))
        found: dict[Path, list[dict[str, float]]] = {page: [] for page in pages}
        for _ in range(asked.often):
            for page in pages:
                found[page].append(in_browser(page, _times))
        medians = {
            page.stem: {s: round(statistics.median(t[s] for t in times)) for s in STEPS}
            for page, times in found.items()
        }
        sizes = {page.stem: f"{page.stat().st_size / 1e6:.2f}" for page in pages}
    outcome = Outcome("report_time", "How long report.html takes in a browser")
    outcome.say(
        f"Milliseconds after the file was opened, median of {asked.often}, a fresh headless",
        "Chromium each time.",
    )
    rows = [
        (name, sizes[name], *(f"{ms} ms" for ms in found.values()))
        for name, found in medians.items()
    ]
    outcome.table(("page", "MB", *STEPS), rows)
    outcome.say("; ".join(f"*{step}*: {told}" for step, told in STEPS.items()) + ".")
    outcome.numbers = {"often": asked.often, "milliseconds": medians}
    outcome.finish(keep=not asked.pages)


if __name__ == "__main__":
    main()
