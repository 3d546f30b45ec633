"""`report.html` in a headless Chromium: every cell is clicked, and nothing is complained of."""

import json

import pytest

from sysid.diagnosis.words import percent
from sysid.report.page.render import render
from tests.report.browser import Tab, find_browser, in_browser
from tests.report.made_page import EVIL, Read, evil_page, many_page

pytestmark = pytest.mark.skipif(
    find_browser() is None, reason="no Chromium on this machine (name one with SYSID_CHROMIUM)"
)
READY = "document.documentElement?.dataset.ready"
CURVES = "document.querySelectorAll('#{} .scatterlayer .trace').length"
WITHOUT_LIBRARY = """(() => {
  const library = window.Plotly, click = () => document.querySelector('[data-test="0"]').click();
  const lines = (id) => document.querySelectorAll(`#detail-${id} svg.sketch polyline`).length;
  window.Plotly = undefined;
  click();
  const found = ["velocity", "displacement", "residual"].map(lines);
  window.Plotly = library;
  click();
  return [...found, lines("velocity")];
})()"""
"""Curves of a test that is chosen before the library is there, and how many stay when it is."""


def sound(tab: Tab, page) -> None:
    assert tab.complaints == []
    assert tab.requested == [page.resolve().as_uri()]


def test_every_cell_opens_its_loops(tmp_path):
    """On a page whose tests have malicious names."""
    path = tmp_path / "report.html"
    path.write_bytes(render(evil_page()))
    read = Read(path.read_bytes())
    tests = json.loads(read.scripts["data"])["tests"]

    async def visit(tab: Tab) -> None:
        await tab.until(READY)
        for cell in read.cells:
            place = cell["data-test"]
            await tab.run(f"document.querySelector('[data-test=\"{place}\"]').click()")
            test = tests[int(place)]
            assert (
                await tab.run("document.getElementById('detail-title').textContent") == test["id"]
            )
            hidden = await tab.run("document.getElementById('detail-velocity').hidden")
            assert hidden == ("f" not in test)
            if not hidden:
                assert await tab.run(CURVES.format("detail-velocity")) == 3
                assert await tab.run(CURVES.format("detail-displacement")) == 3
                assert await tab.run(CURVES.format("detail-residual")) == 2
                rows = await tab.run("document.querySelectorAll('#detail-facts tr').length")
                assert rows == len(test["facts"])
            pressed = "[...document.querySelectorAll('[aria-pressed=true]')].map(c=>c.dataset.test)"
            assert await tab.run(pressed) == [place]
        assert await tab.run(WITHOUT_LIBRARY) == [3, 3, 2, 0]
        assert await tab.run(CURVES.format("detail-velocity")) == 3
        assert await tab.run("window.pwned") is None
        assert await tab.run("document.querySelectorAll('img, svg a').length") == 0

        await tab.run("document.querySelector('input[value=\"0\"]').click()")
        shown = await tab.run(
            "[...document.querySelectorAll('#matrix .error')].map(z => z.textContent)"
        )
        before = [c["data-errors"].split()[:1] for c in read.cells]
        assert shown == [percent(float(e[0])).removesuffix(" %") if e else "out" for e in before]

        await tab.run("document.querySelector('[data-test=\"0\"]').focus()")
        for key, code in (
            ("ArrowRight", 39),
            ("ArrowDown", 40),
            ("ArrowLeft", 37),
            ("ArrowUp", 38),
        ):
            for kind in ("keyDown", "keyUp"):
                await tab.call(
                    "Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code
                )
            moved = await tab.run("document.activeElement.dataset.test")
            if key == "ArrowRight":
                assert moved != "0"
        assert moved == "0"
        assert EVIL[0] in await tab.run("document.body.innerText")
        sound(tab, path)

    in_browser(path, visit)


def test_a_page_of_165_tests_on_a_phone_and_on_paper(tmp_path):
    path = tmp_path / "report.html"
    path.write_bytes(render(many_page()))

    async def visit(tab: Tab) -> None:
        await tab.size(390, 844, phone=True)
        await tab.until(READY)
        wide = await tab.run("document.documentElement.scrollWidth")
        assert wide <= 390
        assert await tab.run("document.querySelectorAll('#damper .points path').length") == 2 * 165
        await tab.run("document.querySelector('[data-test=\"165\"]').click()")
        assert await tab.run(CURVES.format("detail-residual")) == 2
        await tab.size(1280, 900)
        await tab.pdf(tmp_path / "report.pdf")
        assert (tmp_path / "report.pdf").stat().st_size > 20_000
        sound(tab, path)

    in_browser(path, visit)


def test_bars_are_to_scale(tmp_path):
    path = tmp_path / "report.html"
    path.write_bytes(render(many_page()))
    widths = "[...document.querySelectorAll('.stripe')].map(z => z.getBoundingClientRect().width)"

    async def visit(tab: Tab) -> None:
        for width, height, phone in ((1300, 900, False), (390, 844, True)):
            await tab.size(width, height, phone=phone)
            await tab.until(READY)
            before, after = await tab.run(widths)
            assert after / before == pytest.approx(0.2, abs=0.01)  # 1 and 5 %

    in_browser(path, visit)
