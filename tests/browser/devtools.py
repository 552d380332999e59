"""A headless Chromium, driven through its DevTools protocol over a pipe, with what a page
asked for and complained about. Needs nothing beside Python's standard library."""
import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import time

BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def browser():
    """Path of a browser, or None."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


class BrowserError(Exception):
    pass


class Page:
    """One tab. Closed, and the browser with it, at the end of a with statement."""

    def __init__(self, profile, seconds=60):
        """profile: a folder of its own; seconds: for any one answer."""
        self._seconds = seconds
        self._buffer, self._last_id = b"", 0
        self.requests, self.errors = [], []
        self._is_loaded = False
        commands, self._to_browser = os.pipe()
        self._from_browser, answers = os.pipe()
        self._log = open(pathlib.Path(profile) / "browser.log", "w+b")
        # Chromium reads commands from descriptor 3 and answers on 4. It runs without its
        # sandbox, which root and many containers cannot have; pages are our own.
        self._process = subprocess.Popen(
            ["sh", "-c", f'exec "$0" "$@" 3<&{commands} 4>&{answers}', browser(),
             "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--disable-extensions", "--window-size=1200,900",
             f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log,
            pass_fds=(commands, answers), env={**os.environ, "HOME": str(profile)},
        )
        os.close(commands)
        os.close(answers)
        self._session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call(
            "Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self._to_browser)  # which ends it
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._from_browser)
        self._log.close()

    def call(self, method, **parameters):
        self._last_id += 1
        message = {"id": self._last_id, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to_browser, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._read()
            if answer.get("id") == self._last_id:
                if "error" in answer:
                    raise BrowserError(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, uri):
        """Returns when all that is not lazy is there. Begins requests and errors anew."""
        self.requests.clear()
        self.errors.clear()
        self._is_loaded = False
        self.call("Page.navigate", url=uri)
        while not self._is_loaded:
            self._read()

    def value(self, expression):
        """Of a JavaScript expression, whose promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression,
                           awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise BrowserError(json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def screenshot(self, selector):
        """PNG file of the first element that the CSS selector finds."""
        box = self.value(
            f"(function(r) {{ return {{x: r.x + scrollX, y: r.y + scrollY, width: r.width,"
            f" height: r.height, scale: 1}}; }})"
            f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")
        return base64.b64decode(self.call(
            "Page.captureScreenshot", format="png", clip=box, captureBeyondViewport=True)["data"])

    def _read(self):
        deadline = time.monotonic() + self._seconds
        while b"\0" not in self._buffer:
            left = deadline - time.monotonic()
            ready = select.select([self._from_browser], [], [], max(left, 0))[0]
            part = os.read(self._from_browser, 1 << 20) if ready else b""
            if not part:
                self._log.seek(0)
                raise BrowserError(
                    f"the browser {'ended' if ready else 'does not answer'}: "
                    f"{self._log.read().decode(errors='replace')}")
            self._buffer += part
        text, self._buffer = self._buffer.split(b"\0", 1)
        message = json.loads(text)
        self._note(message.get("method"), message.get("params", {}))
        return message

    def _note(self, event, what):
        if event == "Page.loadEventFired":
            self._is_loaded = True
        elif event == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])
        elif event == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(what["exceptionDetails"]))
        elif event == "Runtime.consoleAPICalled":
            self.errors.append(json.dumps(what["args"]))
        elif event == "Log.entryAdded":
            self.errors.append(what["entry"]["text"])
