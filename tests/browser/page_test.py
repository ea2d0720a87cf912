#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""page_test.py PAGE.html SCREENSHOT.png [--views N] [--charts N]

Opens a page of cinch from disk in headless Chromium and uses it: charts are there, views react to mouse, keyboard and
every control, and go back to what they were; no error on the console, no network. N: at least so many. The screenshot,
of the whole page, is kept."""
import argparse
import base64
import pathlib
import re
import sys
import time

from browser import Browser

LEFT, RIGHT, UP, DOWN, HOME, END = "\ue012", "\ue014", "\ue013", "\ue015", "\ue011", "\ue010"
failures = []


def check(holds, what):
    print(f"{'ok  ' if holds else 'FAIL'} {what}")
    if not holds:
        failures.append(what)


def check_charts(browser, least):
    sizes = browser.run("""return [...document.querySelectorAll('figure.chart')].map(figure => {
        const svg = figure.querySelector('svg');
        const drawn = svg ? svg.querySelectorAll('path, polyline, rect, circle, use').length : 0;
        return svg ? [svg.getBoundingClientRect().width, svg.getBoundingClientRect().height, drawn] : [0, 0, 0];
    })""")
    check(len(sizes) >= least, f"{len(sizes)} charts, expected {least} or more")
    for i, (width, height, drawn) in enumerate(sizes):
        check(width > 0 and height > 0 and drawn > 0,
              f"chart {i + 1}: {width:.0f} x {height:.0f} pixels, {drawn} shapes")


class View:
    """One view as its user sees and uses it."""

    def __init__(self, browser, name):
        self.browser, self.name, self.at = browser, name, "#" + name
        browser.run("document.getElementById(arguments[0]).scrollIntoView()", name)
        state = browser.wait("const s = document.getElementById(arguments[0]).dataset.state;"
                             "return s === 'loading' ? '' : s", name)
        check(state == "ready", f"{name}: {state}")
        # What is written over the canvas, and the sign of the focus, are no picture.
        browser.run("""const style = document.createElement('style');
            style.textContent = '.view-info, .view-legend { visibility: hidden }'
                + '.view canvas { outline: none !important }';
            document.head.append(style)""")

    def picture(self):
        """Of the canvas and nothing else: it is all in the window."""
        inside = self.browser.run("const c = document.querySelector(arguments[0]);"
                                  "c.scrollIntoView({block: 'center', behavior: 'instant'});"
                                  "const r = c.getBoundingClientRect(); return r.top >= 0 && r.bottom <= innerHeight",
                                  self.at + " canvas")
        if not inside:
            raise AssertionError(f"{self.name}: the canvas does not fit into the window")
        self.browser.settle()
        return self.browser.picture(self.at + " canvas")

    def info(self):
        return self.browser.run("const v = document.getElementById(arguments[0]);"
                                "const outputs = [...v.querySelectorAll('output')].map(o => o.textContent);"
                                "return [v.querySelector('.view-info').textContent, ...outputs].join('\\n')", self.name)

    def value(self, control):
        return self.browser.run("const v = document.getElementById(arguments[0]);"
                                "const c = v.querySelector(`.view-controls [name=${arguments[1]}]`);"
                                "return c && (c.type === 'checkbox' ? c.checked : c.value)", self.name, control)

    def has(self, control):
        return self.value(control) is not None

    def changes(self, what, act, back=None, text=True):
        """act() changes the picture (and with `text` what is written); back() restores it."""
        before, said = self.picture(), self.info()
        act()
        check(self.soon(lambda: self.picture() != before), f"{self.name}: {what} changes the picture")
        if text:
            check(self.info() != said, f"{self.name}: {what} changes what is written")
        if back:
            back()
            check(self.soon(lambda: self.picture() == before), f"{self.name}: {what}, and the way back restores it")

    def soon(self, holds):
        """Software draws slowly."""
        return any(holds() or time.sleep(0.2) for _ in range(10))

    def slide(self, control, share):
        """Clicks on a slider where it means this share of its range."""
        self.browser.click_within(f"{self.at} .view-controls input[name={control}]", share)

    def slide_back(self, frame):
        """To the middle, and from there by keys: a pixel may be a frame."""
        self.slide("frame", 0.5)
        off = int(self.value("frame")) - frame
        check(abs(off) <= 1, f"{self.name}: the frame slider goes where it is clicked")
        self.browser.keys((LEFT if off > 0 else RIGHT) * abs(off))

    def choose(self, control, value):
        """By keyboard, in the closed list."""
        self.browser.run("const v = document.getElementById(arguments[0]);"
                         "v.querySelector(`.view-controls select[name=${arguments[1]}]`).focus()", self.name, control)
        self.browser.keys(HOME + DOWN * self.options(control).index(value))

    def options(self, control):
        return self.browser.run("const v = document.getElementById(arguments[0]);"
                                "const all = v.querySelectorAll(`.view-controls [name=${arguments[1]}] option`);"
                                "return [...all].map(o => o.value)", self.name, control)

    def tick(self, control):
        self.browser.click(f"{self.at} .view-controls input[name={control}]")

    def focus(self):
        self.browser.click(self.at + " canvas")

    def test(self):
        b = self.browser
        check(self.picture() == self.picture(), f"{self.name}: two pictures of the same are the same")
        levels = b.run("return Number(document.getElementById(arguments[0]).querySelector('input[name=level]').max)",
                       self.name)
        self.slide("frame", 0.03)  # away from the middle: a click on the handle does not move it
        self.slide("frame", 0.5)
        here = int(self.value("frame"))
        self.changes("the frame slider", lambda: self.slide("frame", 0.97), lambda: self.slide_back(here))
        if levels > 0:
            self.slide("level", 0)
            self.changes("the level slider", lambda: self.slide("level", 1), lambda: self.slide("level", 0))
        methods = self.options("method")
        if len(methods) > 1:
            self.choose("method", methods[0])
            self.changes("the choice of method", lambda: self.choose("method", methods[-1]),
                         lambda: self.choose("method", methods[0]))
        kdops = self.options("k")
        if len(kdops) > 1:
            other = kdops[-1] if self.value("k") != kdops[-1] else kdops[0]
            self.changes("the choice of k", lambda: self.choose("k", other))
        self.choose("surface", "solid")
        self.changes("glass", lambda: self.choose("surface", "glass"), lambda: self.choose("surface", "solid"),
                     text=False)
        self.changes("no surface", lambda: self.choose("surface", "hidden"), lambda: self.choose("surface", "solid"),
                     text=False)
        for control in ("bounds", "truth", "nodes"):
            if self.has(control):
                self.choose("surface", "glass")
                self.changes(f"the box '{control}'", lambda: self.tick(control), lambda: self.tick(control), text=False)
        if self.has("contacts"):
            self.find_contacts()
            self.changes("the box 'contacts'", lambda: self.tick("contacts"), lambda: self.tick("contacts"), text=False)
        self.test_keys(methods, kdops, levels)
        self.test_mouse()

    def find_contacts(self):
        """Goes to a frame with some."""
        self.focus()
        self.browser.keys(HOME)
        for _ in range(200):
            if not re.search(r"^0 pairs", self.info(), re.M):
                return
            self.browser.keys(RIGHT)
        check(False, f"{self.name}: a frame with intersecting triangles")

    def test_keys(self, methods, kdops, levels):
        keys = self.browser.keys
        self.focus()
        keys(HOME + RIGHT)
        self.changes("key right", lambda: keys(RIGHT), lambda: keys(LEFT))
        check(self.value("frame") == "1", f"{self.name}: home, right, right, left is the second frame")
        self.changes("key end", lambda: keys(END), lambda: keys(HOME + RIGHT))
        if levels > 0:
            keys(DOWN * 20)
            self.changes("key up", lambda: keys(UP), lambda: keys(DOWN))
        if len(methods) > 1:
            self.choose("method", methods[0])
            self.focus()
            self.changes("key M", lambda: keys("M"), lambda: keys("m"))
            keys("m")
            check(self.value("method") == methods[1], f"{self.name}: key m goes to the next method")
            keys("M")
        if len(kdops) > 1:
            self.changes("key k", lambda: keys("k"), lambda: keys("k" * (len(kdops) - 1)))
        measure = self.value("measure")
        keys("c")
        check(self.value("measure") != measure, f"{self.name}: key c measures otherwise")
        self.changes("key s", lambda: keys("s"), lambda: keys("ss"), text=False)
        for key, control in (("f", "bounds"), ("t", "truth"), ("n", "nodes")):
            if self.has(control):
                self.changes(f"key {key}", lambda: keys(key), lambda: keys(key), text=False)
        if self.has("contacts"):
            ticked = self.value("contacts")
            keys("i")
            check(self.value("contacts") != ticked, f"{self.name}: key i is for contacts")
            keys("i")
        keys("r")
        self.changes("key +", lambda: keys("++"), lambda: keys("r"), text=False)
        before = self.value("frame")
        keys(" ")
        self.browser.wait("const v = document.getElementById(arguments[0]);"
                          "return v.querySelector('[name=frame]').value !== arguments[1]"
                          "    && v.querySelector('[name=play]').textContent === 'Pause'",
                          self.name, before, seconds=30)
        keys(" ")
        self.browser.settle()
        stopped = self.value("frame")
        time.sleep(0.5)
        check(self.value("frame") == stopped, f"{self.name}: key space plays, and pauses")

    def test_mouse(self):
        b, canvas = self.browser, self.at + " canvas"
        self.focus()
        b.keys("r")
        restore = lambda: b.keys("r")
        self.changes("dragging", lambda: b.drag(canvas, 120, 40), restore, text=False)
        self.changes("dragging with the right button", lambda: b.drag(canvas, 60, 30, button=2), restore, text=False)
        self.changes("the wheel", lambda: b.scroll(canvas, -300), restore, text=False)


def whole_page(browser, file):
    """The page from top to bottom, as far as browsers go."""
    size = browser.run("return [document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
    made = browser.call("POST", "/goog/cdp/execute", {"cmd": "Page.captureScreenshot", "params": {
        "captureBeyondViewport": True,
        "clip": {"x": 0, "y": 0, "width": size[0], "height": min(size[1], 12000), "scale": 1}}})
    pathlib.Path(file).write_bytes(base64.b64decode(made["data"]))


def quiet(browser, page, how):
    errors = [entry["message"] for entry in browser.console() if entry["level"] == "SEVERE"]
    check(not errors, f"no error on the console{how}" + "".join("\n     " + e[:300] for e in errors))
    own = pathlib.Path(page).resolve().as_uri()
    asked = [url for url in browser.requests() if url != own and not url.startswith(("data:", "blob:"))]
    check(not asked, f"no network{how}" + "".join("\n     " + url[:300] for url in asked))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page")
    parser.add_argument("screenshot")
    parser.add_argument("--views", type=int, default=1)
    parser.add_argument("--charts", type=int, default=0)
    options = parser.parse_args()
    with Browser() as browser:
        browser.open(options.page)
        check_charts(browser, options.charts)
        names = browser.run("return [...document.querySelectorAll('section.view')].map(v => v.id)")
        check(len(names) >= options.views, f"{len(names)} views, expected {options.views} or more")
        for name in names:
            View(browser, name).test()
        browser.run("for (const s of document.querySelectorAll('style'))"
                    "    if (s.textContent.startsWith('.view-info')) s.remove();"
                    "scrollTo(0, 0)")
        browser.settle()
        whole_page(browser, options.screenshot)
        quiet(browser, options.page, "")
    with Browser(webgl=False) as browser:
        browser.open(options.page)
        for name in names:
            browser.run("document.getElementById(arguments[0]).scrollIntoView()", name)
            browser.wait("return document.getElementById(arguments[0]).dataset.state === 'unsupported'", name)
            said = browser.run("const notes = document.getElementById(arguments[0]).querySelectorAll('.view-note');"
                               "return [...notes].map(n => n.textContent).join(' ')", name)
            check("WebGL" in said, f"{name}: without WebGL it says so")
        quiet(browser, options.page, " without WebGL")
    print(f"\n{len(failures)} failed" if failures else "\nall passed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
