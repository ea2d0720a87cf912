#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a page of cinch from disk, as a reader would: report_test.py PAGE.html SCREENSHOT.png [--views N] [--charts N]

No error on the console, nothing asked of a network, every chart there, and in every 3-D view frame, level, method, keys and mouse change
the picture. --views and --charts: at least so many."""
import argparse
import io
import pathlib
import struct
import sys
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from browser import Browser  # noqa: E402

failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED:", what)


def pixels(png):
    """The rows of a PNG, unfiltered: enough to tell whether two pictures differ, and whether one is blank."""
    data, at, width, rows = io.BytesIO(png), 8, 0, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", png[at + 8:at + 18])
        if kind == b"IDAT":
            rows += png[at + 8:at + 8 + length]
        at += 12 + length
    raw, channels = zlib.decompress(rows), {2: 3, 6: 4}[colour]
    stride, out, above = width * channels, [], bytes(width * channels)
    for y in range(height):
        filter_, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = line[i - channels] if i >= channels else 0, above[i], above[i - channels] if i >= channels else 0
            if filter_ == 1:
                line[i] = (line[i] + a) & 255
            elif filter_ == 2:
                line[i] = (line[i] + b) & 255
            elif filter_ == 3:
                line[i] = (line[i] + (a + b) // 2) & 255
            elif filter_ == 4:
                p = a + b - c
                pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                line[i] = (line[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        out.append(bytes(line))
        above = line
    return out


def differ(a, b):
    return a != b and pixels(a) != pixels(b)


class TestedView:
    def __init__(self, browser, number):
        self.browser, self.number, self.at = browser, number, f"section.view:nth-of-type({number})"
        browser.run("document.querySelectorAll('section.view')[arguments[0]].scrollIntoView()", number)
        browser.wait("return document.querySelectorAll('section.view')[arguments[0]].dataset.state === 'ready'", number)
        self.title = browser.run("return document.querySelectorAll('section.view')[arguments[0]].querySelector('h2').textContent", number)
        browser.run("document.querySelectorAll('section.view')[arguments[0]].querySelector('canvas').id = 'tested-' + arguments[0]", number)
        self.canvas = f"#tested-{number}"
        browser.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", self.canvas)

    def picture(self):
        # two frames later, when what was asked for is drawn
        self.browser.call("POST", "/execute/async", {"script": "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done(1)))", "args": []})
        return self.browser.picture(self.canvas)

    def value(self, name):
        return self.browser.run("return document.querySelectorAll('section.view')[arguments[0]].querySelector(`.view-controls [name=${arguments[1]}]`).value", self.number, name)

    def set(self, name, value):
        self.browser.run("""const control = document.querySelectorAll('section.view')[arguments[0]].querySelector(`.view-controls [name=${arguments[1]}]`);
            control.value = arguments[2]; control.dispatchEvent(new Event('input', {bubbles: true}));""", self.number, name, value)

    def tick(self, name, on):
        self.browser.run("""const control = document.querySelectorAll('section.view')[arguments[0]].querySelector(`.view-controls [name=${arguments[1]}]`);
            if (control) { control.checked = arguments[2]; control.dispatchEvent(new Event('input', {bubbles: true})); }""", self.number, name, on)

    def limit(self, name):
        return int(self.browser.run("return document.querySelectorAll('section.view')[arguments[0]].querySelector(`.view-controls [name=${arguments[1]}]`).max", self.number, name))

    def options(self, name):
        return self.browser.run("return [...document.querySelectorAll('section.view')[arguments[0]].querySelector(`.view-controls [name=${arguments[1]}]`).options].map(o => o.value)",
                                self.number, name)

    def changed(self, what, before):
        after = self.picture()
        check(differ(before, after), f"{self.title}: {what} changes the picture")
        return after

    def test(self):
        # the picture alone, without the text that lies on it
        self.browser.run("document.head.append(Object.assign(document.createElement('style'), {textContent: '.view-info, .view-legend { visibility: hidden }'}))")
        now = self.picture()
        check(len(set(pixels(now)[len(pixels(now)) // 2])) > 8, f"{self.title}: something is drawn")
        self.set("surface", "solid")
        for name in ("bounds", "truth", "nodes", "contacts"):
            self.tick(name, False)
        self.set("frame", 0)
        first = self.picture()
        self.set("frame", self.limit("frame"))
        now = self.changed("the frame slider, by the surface alone,", first)
        self.tick("bounds", True)
        now = self.changed("showing the bounds", now)
        self.set("level", 0)
        top = self.picture()
        self.set("level", self.limit("level"))
        now = self.changed("the level slider", top)
        self.set("level", 1)
        methods = self.options("method")
        check(len(methods) >= 2, f"{self.title}: offers methods")
        self.set("method", "best")
        best = self.picture()
        self.set("method", "sphere" if "sphere" in methods else methods[-1])
        now = self.changed("the choice of a method", best)
        self.browser.click(self.canvas)
        frame, level, method = self.value("frame"), self.value("level"), self.value("method")
        now = self.picture()
        self.browser.keys("\ue012")  # left
        check(self.value("frame") == str(int(frame) - 1), f"{self.title}: the left arrow goes one frame back")
        self.browser.keys("\ue013")  # up
        check(self.value("level") == str(int(level) + 1), f"{self.title}: the up arrow goes one level down the tree")
        self.browser.keys("m")
        check(self.value("method") != method, f"{self.title}: m changes the method")
        now = self.changed("the keyboard", now)
        self.browser.drag(self.canvas, 120, 40)
        self.changed("dragging", now)
        frame = self.value("frame")
        self.browser.keys(" ")
        self.browser.wait("""return document.querySelectorAll('section.view')[arguments[0]].querySelector('.view-controls [name=frame]').value !== arguments[1]""", self.number, frame)
        self.browser.keys(" ")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page")
    parser.add_argument("screenshot")
    parser.add_argument("--views", type=int, default=0)
    parser.add_argument("--charts", type=int, default=0)
    given = parser.parse_args()
    with Browser() as browser:
        browser.requests()
        browser.open(given.page)
        charts = browser.run("""return [...document.querySelectorAll('figure.chart')].map(f => {
            const svg = f.querySelector('svg'), box = svg ? svg.getBoundingClientRect() : {width: 0, height: 0};
            return [f.textContent.trim().slice(0, 60), box.width, box.height, svg ? svg.querySelectorAll('path').length : 0];})""")
        check(len(charts) >= given.charts, f"{given.charts} charts, found {len(charts)}")
        for name, width, height, paths in charts:
            check(width > 100 and height > 100 and paths > 3, f"chart '{name}' is drawn: {width} x {height}, {paths} paths")
        views = browser.run("return document.querySelectorAll('section.view').length")
        check(views >= given.views, f"{given.views} views, found {views}")
        for number in range(views):
            TestedView(browser, number).test()
        browser.run("document.querySelectorAll('head style:last-of-type').forEach(s => s.textContent.startsWith('.view-info,') && s.remove()); window.scrollTo(0, 0)")
        pathlib.Path(given.screenshot).write_bytes(browser.picture())
        for entry in browser.console():
            check(False, f"console: {entry['level']}: {entry['message']}")
        for address in browser.requests():
            check(address.startswith(("file:", "data:", "blob:")), f"asked a network for {address}")
    print(f"{views} views, {len(charts)} charts, {len(failures)} failures; {given.screenshot}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
