"""From a page's content to one HTML file that needs nothing but itself."""

import base64
import gzip
import json
import pkgutil
from functools import cache
from typing import Any, Final

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from sysid.report.page.page import Page
from sysid.report.page.wording import share

PACKAGE: Final = "sysid.report.page"

POLICY: Final = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'"
)
"""Content security policy: the browser itself refuses every request to anywhere."""


def render(page: Page) -> bytes:
    """The page as UTF-8; the same page gives the same bytes.

    Texts are escaped wherever they come from; the data of the script cannot end its element, and
    the script puts them into text nodes only.
    """
    text = _environment().get_template("page.html.jinja").render(
        page=page, policy=POLICY, data=embedded(page.data()), plotly=_plotly(),
        style=_source("page.css"), script=_source("page.js"),
    )  # fmt: skip
    return text.encode()


def embedded(data: Any) -> Markup:
    """JSON that can stand within a script element, whatever strings it holds."""
    text = json.dumps(data, allow_nan=False, ensure_ascii=True, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


@cache
def _environment() -> Environment:
    found = Environment(
        loader=PackageLoader(PACKAGE, "templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    found.filters["share"] = share
    return found


@cache
def _plotly() -> Markup:
    """Plotly's script, packed: 2 MB instead of 4.8; the page unpacks it."""
    source = pkgutil.get_data("plotly", "package_data/plotly.min.js")
    if source is None:
        raise FileNotFoundError("plotly is installed without its script plotly.min.js")
    return Markup(base64.b64encode(gzip.compress(source, 6, mtime=0)).decode("ascii"))


def _source(name: str) -> Markup:
    source = pkgutil.get_data(PACKAGE, f"templates/{name}")
    if source is None:
        raise FileNotFoundError(f"sysid is installed without {name}")
    return Markup(source.decode())
