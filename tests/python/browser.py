"""Controls a headless Chromium by its DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
"""The browser, if one is installed."""


FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-breakpad",
    "--disable-component-update",
    "--disable-extensions",
    "--no-default-browser-check",
    "--no-first-run",
    "--password-store=basic",
    "--remote-debugging-port=0",
)
"""A browser that needs nothing of the machine around it: no key ring, no network, no shared memory."""

STARTS = 8
"""So many times a browser is started: now and then one hangs before it listens, and the next does not."""


class BrowserEndedError(Exception):
    """A browser ended before its page could be controlled."""


class Browser:
    """One page in its own browser. The browser ends with the block."""

    def __init__(self, program: str | None = PROGRAM) -> None:
        assert program is not None, "a browser is installed"
        self._program = program
        self._number = 0
        self.log: list[str] = []
        """Console output of the page, and errors of its scripts."""

    async def __aenter__(self) -> Browser:
        for start in range(1, STARTS + 1):
            self._start()
            try:
                await asyncio.wait_for(self._connect(), 15 * start)
            except (TimeoutError, asyncio.TimeoutError, OSError, BrowserEndedError):
                self._stop()
            else:
                return self
        raise AssertionError(f"the browser does not start; it says\n{self._said}")

    def _start(self) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="cognate-browser-"))
        with (self._folder / "stderr").open("wb") as stderr:
            self._process = subprocess.Popen(
                [self._program, *FLAGS, f"--user-data-dir={self._folder}", "about:blank"],
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                start_new_session=True,
            )

    async def _connect(self) -> None:
        """Controls the first page, once it is there."""
        from tornado.websocket import websocket_connect

        self._socket = await websocket_connect(await self._page(), max_message_size=1 << 28)
        for domain in ("Page", "Runtime", "Log"):
            await self.call(f"{domain}.enable")

    async def _page(self) -> str:
        """The address of the page that the browser opens first."""
        file = self._folder / "DevToolsActivePort"
        while True:
            if self._process.poll() is not None:
                raise BrowserEndedError
            lines = file.read_text().splitlines() if file.exists() else []
            if lines:
                with urllib.request.urlopen(f"http://127.0.0.1:{lines[0]}/json/list", timeout=15) as answer:
                    targets = json.load(answer)
                for target in targets:
                    if target["type"] == "page":
                        return str(target["webSocketDebuggerUrl"])
            await asyncio.sleep(0.1)

    def _stop(self) -> None:
        """Ends the browser and the processes that it has started, and removes its folder."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._said = (self._folder / "stderr").read_text(errors="replace")[-2000:]
        shutil.rmtree(self._folder, ignore_errors=True)

    async def __aexit__(self, *_: object) -> None:
        self._socket.close()
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._closed(), 5)
        self._stop()

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
            text = await asyncio.wait_for(self._socket.read_message(), 300)
            if text is None:
                raise BrowserEndedError
            message = json.loads(text)
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
