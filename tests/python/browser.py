"""Controls a headless Chromium by its DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import shutil
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
"""The browser, if one is installed."""


class Browser:
    """One page in its own browser. The browser ends with the block."""

    def __init__(self) -> None:
        assert PROGRAM is not None, "a browser is installed"
        self._folder = tempfile.mkdtemp(prefix="cognate-browser-")
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--no-first-run"]
        self._process = subprocess.Popen(
            [PROGRAM, *flags, f"--user-data-dir={self._folder}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        port = Path(self._folder) / "DevToolsActivePort"
        end = time.monotonic() + 600
        while not port.exists() or not port.read_text().strip():
            assert time.monotonic() < end, "the browser does not start"
            time.sleep(0.1)
        self._port = int(port.read_text().splitlines()[0])
        self._number = 0
        self.log: list[str] = []
        """Console output of the page, and errors of its scripts."""

    async def __aenter__(self) -> Browser:
        from tornado.websocket import websocket_connect

        with urllib.request.urlopen(f"http://127.0.0.1:{self._port}/json/list") as answer:
            pages = json.load(answer)
        url = next(page["webSocketDebuggerUrl"] for page in pages if page["type"] == "page")
        self._socket = await websocket_connect(url, max_message_size=1 << 28)
        for domain in ("Page", "Runtime", "Log"):
            await self.call(f"{domain}.enable")
        return self

    async def __aexit__(self, *_: object) -> None:
        self._socket.close()
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._closed(), 5)
        self._process.terminate()
        self._process.wait(20)
        shutil.rmtree(self._folder, ignore_errors=True)

    async def _closed(self) -> None:
        """Waits until the other side has also closed the connection."""
        while await self._socket.read_message() is not None:
            pass

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Calls the browser, and waits for its answer."""
        self._number += 1
        number = self._number
        await self._socket.write_message(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(await asyncio.wait_for(self._socket.read_message(), 60))
            kind = message.get("method")
            if kind == "Runtime.exceptionThrown":
                self.log.append(json.dumps(message["params"]["exceptionDetails"]))
            elif kind == "Log.entryAdded":
                self.log.append(message["params"]["entry"]["text"])
            if message.get("id") == number:
                assert "error" not in message, message
                result: dict[str, Any] = message["result"]
                return result

    async def go(self, url: str) -> None:
        """Opens an address."""
        await self.call("Page.navigate", url=url)
        await self.until("document.readyState === 'complete'")

    async def run(self, script: str) -> Any:
        """The value of an expression in the page."""
        answer = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    async def until(self, condition: str, seconds: float = 300.0) -> None:
        """Waits until an expression is true."""
        end = time.monotonic() + seconds
        while not await self.run(f"Boolean({condition})"):
            if time.monotonic() > end:
                text = await self.run("document.body.innerText")
                raise AssertionError(f"{condition} did not become true; the page shows\n{text}\n{self.log}")
            await asyncio.sleep(0.1)

    async def size(self, width: int, height: int) -> None:
        """Sets the size of the window."""
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False
        )

    async def picture(self, file: Path) -> None:
        """Writes a picture of the whole page."""
        found = await self.call("Page.captureScreenshot", captureBeyondViewport=True)
        file.write_bytes(base64.b64decode(found["data"]))
