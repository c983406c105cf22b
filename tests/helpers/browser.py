"""A headless Chromium over its debugging pipe: enough of it to look at one page."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, _NAMES)), None)

PATIENCE = 40.0
"""Longest silence of a browser (s)."""


class Browser:
    """One page of a browser.

    Attributes:
        complaints: What its console said, and what could not be loaded.
    """

    def __init__(self, write: int, read: int) -> None:
        self._write, self._read = write, read
        self._rest = b""
        self._number = 0
        self._session: str | None = None
        self.complaints: list[str] = []

    def attach(self) -> None:
        target = self("Target.createTarget", url="about:blank")["targetId"]
        self._session = self("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self(f"{domain}.enable")

    def __call__(self, method: str, **given: Any) -> dict[str, Any]:
        self._number += 1
        message = {"id": self._number, "method": method, "params": given}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            heard = self._hear()
            if heard.get("id") == self._number:
                assert "error" not in heard, heard
                return dict(heard["result"])
            self._note(heard)

    def open(self, path: Path, *, width: int, dark: bool) -> None:
        """Show a file, and wait until it is there."""
        self("Emulation.setDeviceMetricsOverride", width=width, height=844,
             deviceScaleFactor=1, mobile=width < 600)  # fmt: skip
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self("Emulation.setEmulatedMedia", features=[scheme])
        self("Page.navigate", url=path.resolve().as_uri())
        while True:
            heard = self._hear()
            self._note(heard)
            if heard.get("method") == "Page.loadEventFired":
                return

    def value(self, expression: str) -> Any:
        """What an expression comes to, in the page."""
        told = self(
            "Runtime.evaluate",
            expression=expression,
            returnByValue=True,
            awaitPromise=True,
        )
        assert "exceptionDetails" not in told, told
        return told["result"].get("value")

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press a key and let it go: a character, or a name such as ``ArrowLeft``."""
        given: dict[str, Any] = {"key": key, "modifiers": 8 if shift else 0}
        text = {"text": key} if len(key) == 1 else {}
        self("Input.dispatchKeyEvent", type="keyDown", **given, **text)
        self("Input.dispatchKeyEvent", type="keyUp", **given)

    def drag(self, *points: tuple[float, float]) -> None:
        """Press the mouse at the first point (CSS pixels), move it along, let go at the last."""
        held = {"button": "left", "clickCount": 1}
        first, *further = points
        for kind, (x, y), buttons in (
            ("mouseMoved", first, 0),
            ("mousePressed", first, 1),
            *(("mouseMoved", point, 1) for point in further),
            ("mouseReleased", points[-1], 0),
        ):
            self("Input.dispatchMouseEvent", type=kind, x=x, y=y, buttons=buttons, **held)

    def touch(self, *points: tuple[float, float]) -> None:
        """Touch the first point (CSS pixels), move along the others, let go."""
        kinds = ["touchStart", *["touchMove"] * (len(points) - 1)]
        for kind, (x, y) in zip(kinds, points, strict=True):
            self("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y}])
        self("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, *, whole: bool = False) -> bytes:
        """A PNG of what is to be seen; or of the whole page."""
        given = {"captureBeyondViewport": True} if whole else {}
        if whole:
            size = self("Page.getLayoutMetrics")["cssContentSize"]
            given["clip"] = {**size, "scale": 1}
        return base64.b64decode(self("Page.captureScreenshot", format="png", **given)["data"])

    def _note(self, heard: dict[str, Any]) -> None:
        method, given = heard.get("method"), heard.get("params", {})
        if method == "Log.entryAdded":
            self.complaints.append(f"{given['entry']['level']}: {given['entry']['text']}")
        elif method in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown"):
            self.complaints.append(json.dumps(given)[:300])
        elif method == "Network.loadingFailed":
            self.complaints.append(f"not loaded: {given.get('errorText')}")

    def _hear(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            assert select.select([self._read], [], [], PATIENCE)[0], "the browser hangs"
            more = os.read(self._read, 1 << 20)
            assert more, "the browser is gone"
            self._rest += more
        line, _, self._rest = self._rest.partition(b"\0")
        return dict(json.loads(line))


@contextmanager
def browsing(profile: Path) -> Iterator[Browser]:
    """Start a browser with a profile of its own, and end it."""
    assert CHROMIUM is not None
    to_read, ours_out = os.pipe()
    ours_in, to_write = os.pipe()
    # The pipe must be file 3 (it reads) and 4 (it writes); a shell puts them there.
    script = f'exec 3<&{to_read} 4>&{to_write}; exec "$@"'
    command = [
        *("bash", "-c", script, "bash", CHROMIUM, "--headless=new", "--remote-debugging-pipe"),
        *("--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--disable-dev-shm-usage"),
        *("--no-first-run", "--disable-background-networking", f"--user-data-dir={profile}"),
    ]
    with (profile.parent / "chromium.log").open("wb") as log:
        process = subprocess.Popen(
            command, pass_fds=(to_read, to_write), stdout=log, stderr=log, start_new_session=True
        )
        os.close(to_read)
        os.close(to_write)
        try:
            browser = Browser(ours_out, ours_in)
            browser.attach()
            yield browser
        finally:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            os.close(ours_out)
            os.close(ours_in)
