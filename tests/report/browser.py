"""A headless Chromium, spoken to in its own protocol: no driver has to be installed."""

import asyncio
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PORT_FILE = "DevToolsActivePort"
STARTED_WITHIN = 60.0

Call = Callable[..., Awaitable[dict[str, Any]]]


def find_browser() -> str | None:
    """A browser of this machine: what SYSID_CHROMIUM names, or the first one on the path."""
    told = os.environ.get("SYSID_CHROMIUM")
    return told or next((path for path in map(shutil.which, NAMES) if path), None)


class Tab:
    """One page that is open, with everything that it complained of."""

    def __init__(self, socket: Any) -> None:
        self.socket, self.number = socket, 0
        self.complaints: list[str] = []
        self.requested: list[str] = []

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """One command; events that come meanwhile are kept."""
        self.number += 1
        sent = {"id": self.number, "method": method, "params": parameters}
        await self.socket.write_message(json.dumps(sent))
        while True:
            text = await asyncio.wait_for(self.socket.read_message(), 60)
            assert text is not None, "the browser went away"
            message = json.loads(text)
            if message.get("id") == sent["id"]:
                assert "error" not in message, message
                return message["result"]
            self._keep(message)

    async def run(self, script: str) -> Any:
        """The value of a piece of JavaScript."""
        told = await self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in told, told
        return told["result"].get("value")

    async def until(self, script: str, within: float = 60.0) -> None:
        """Wait until a condition holds."""
        end = time.monotonic() + within
        while not await self.run(f"Boolean({script})"):
            assert time.monotonic() < end, f"not within {within:g} s: {script}; {self.complaints}"
            await asyncio.sleep(0.05)

    async def size(self, width: int, height: int, *, phone: bool = False) -> None:
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height,
            deviceScaleFactor=1, mobile=phone,
        )  # fmt: skip

    async def picture(self, path: Path, *, whole: bool = False) -> None:
        told = await self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(told["data"]))

    async def pdf(self, path: Path) -> None:
        told = await self.call("Page.printToPDF", printBackground=False, preferCSSPageSize=True)
        path.write_bytes(base64.b64decode(told["data"]))

    def _keep(self, message: dict[str, Any]) -> None:
        method, told = message.get("method"), message.get("params", {})
        if method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(z.get("value", z)) for z in told["args"]))
        elif method == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.complaints.append(str(details.get("exception", details).get("description")))
        elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.complaints.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requested.append(told["request"]["url"])


def in_browser(page: Path, visit: Callable[[Tab], Awaitable[Any]]) -> Any:
    """Open a file in a fresh browser and do something with it.

    Args:
        page: The file.
        visit: Called with the tab once the page has begun to load.
    """
    from tornado.websocket import websocket_connect

    async def go(address: str) -> Any:
        socket = await websocket_connect(address, max_message_size=2**28)
        tab = Tab(socket)
        for domain in ("Runtime", "Log", "Network", "Page"):
            await tab.call(f"{domain}.enable")
        await tab.size(1280, 900)
        try:
            await tab.call("Page.navigate", url=page.resolve().as_uri())
            return await visit(tab)
        finally:
            socket.close()
            while await asyncio.wait_for(socket.read_message(), 20) is not None:
                pass

    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [
            find_browser() or "chromium", "--headless=new", "--no-sandbox", "--disable-gpu",
            "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars",
            "--disable-background-networking", "--disable-extensions",
            "--remote-debugging-port=0", f"--user-data-dir={profile}", "about:blank",
        ]  # fmt: skip
        quiet = subprocess.DEVNULL
        process = subprocess.Popen(command, stdout=quiet, stderr=quiet, start_new_session=True)
        try:
            return asyncio.run(go(_address(Path(profile), process)))
        finally:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _address(profile: Path, process: subprocess.Popen) -> str:
    """Of the first tab."""
    import urllib.request

    end = time.monotonic() + STARTED_WITHIN
    while time.monotonic() < end and process.poll() is None:
        try:
            port = (profile / PORT_FILE).read_text().split()[0]
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=5) as answer:
                tabs = json.loads(answer.read())
            return next(t["webSocketDebuggerUrl"] for t in tabs if t["type"] == "page")
        except (OSError, IndexError, StopIteration):
            time.sleep(0.1)
    raise RuntimeError("the browser did not start")
