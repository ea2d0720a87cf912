# SPDX-License-Identifier: GPL-3.0-or-later
"""Headless Chromium by WebDriver, with the standard library alone. Debian: chromium, chromium-driver."""
import base64
import http.client
import json
import pathlib
import shutil
import subprocess
import time


class Browser:
    """with Browser(width, height) as b: b.open(path); b.run("return 1 + 1") ..."""

    def __init__(self, width=1100, height=900, scale=1, webgl=True):
        driver, chromium = shutil.which("chromedriver"), shutil.which("chromium")
        if not driver or not chromium:
            raise SystemExit("SKIPPED: chromium is missing; on Debian: apt-get install chromium chromium-driver")
        self.driver = subprocess.Popen([driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                       text=True)
        port = None
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                port = int(line.rstrip().rstrip(".").rsplit(" ", 1)[1])
                break
        if port is None:
            raise SystemExit("chromedriver does not start")
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=300)
        gl = (["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] if webgl
              else ["--disable-gpu", "--disable-3d-apis"])
        options = {"binary": chromium, "args": ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                                                "--hide-scrollbars", "--allow-file-access-from-files=false",
                                                f"--window-size={width},{height}",
                                                f"--force-device-scale-factor={scale}", *gl]}
        try:
            made = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
                "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}}},
                session=False)
        except Exception:
            self.driver.terminate()
            raise
        self.session = "/session/" + made["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def call(self, verb, path, body=None, session=True):
        text = json.dumps(body if body is not None else {}) if verb == "POST" else None
        self.connection.request(verb, (self.session if session else "") + path, text,
                                {"Content-Type": "application/json"})
        answer = json.loads(self.connection.getresponse().read())["value"]
        if isinstance(answer, dict) and "error" in answer:
            raise RuntimeError(f"{verb} {path}: {answer['error']}: {answer['message'].splitlines()[0]}")
        return answer

    def open(self, path):
        self.call("POST", "/url", {"url": pathlib.Path(path).resolve().as_uri()})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, script, *arguments, seconds=120):
        """Until the script returns something true, which is returned."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if result := self.run(script, *arguments):
                return result
            time.sleep(0.1)
        raise AssertionError(f"after {seconds} s still not: {script} {arguments}")

    def settle(self):
        """Until what was asked for is drawn."""
        self.call("POST", "/execute/async", {"args": [], "script": "const done = arguments[0];"
                  "requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done)))"})

    def find(self, selector):
        return next(iter(self.call("POST", "/element", {"using": "css selector", "value": selector}).values()))

    def click(self, selector):
        self.call("POST", f"/element/{self.find(selector)}/click")

    def click_within(self, selector, share):
        """A click at that share of the element's width, within the handle's reach at its ends."""
        box = self.run("const r = document.querySelector(arguments[0]).getBoundingClientRect();"
                       "return [r.width, r.height]", selector)
        here = {"element-6066-11e4-a52e-4f735466cecf": self.find(selector)}
        x = round((share - 0.5) * (box[0] - 6))
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "duration": 0, "origin": here, "x": x, "y": 0},
            {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]}]})

    def keys(self, text):
        """Types into whatever has the focus."""
        actions = [{"type": kind, "value": key} for key in text for kind in ("keyDown", "keyUp")]
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})

    def drag(self, selector, dx, dy, button=0):
        here = {"element-6066-11e4-a52e-4f735466cecf": self.find(selector)}
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "duration": 0, "origin": here, "x": 0, "y": 0},
            {"type": "pointerDown", "button": button},
            {"type": "pointerMove", "duration": 50, "origin": here, "x": dx, "y": dy},
            {"type": "pointerUp", "button": button}]}]})

    def scroll(self, selector, dy):
        here = {"element-6066-11e4-a52e-4f735466cecf": self.find(selector)}
        self.call("POST", "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "origin": here, "x": 0, "y": 0, "deltaX": 0, "deltaY": dy, "duration": 50}]}]})

    def picture(self, selector=None):
        """PNG of an element as it is on the screen, or of the window."""
        return base64.b64decode(self.call(
            "GET", f"/element/{self.find(selector)}/screenshot" if selector else "/screenshot"))

    def console(self):
        return self.call("POST", "/se/log", {"type": "browser"})

    def requests(self):
        """Addresses that were asked for since the last call, but for the page's own."""
        events = (json.loads(entry["message"])["message"]
                  for entry in self.call("POST", "/se/log", {"type": "performance"}))
        return [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
