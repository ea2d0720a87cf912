#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""site_test.py SITE PICTURES: the site of the library in headless Chromium. On every page, on a telephone's screen, and
on those of 1,100 and 1,400 pixels: nothing is asked for from outside the site, no script fails, nothing is wider than
the screen. The bounds of a character are clicked to; light and dark are both there; links that leave say so. Pictures
of the first pages stay in PICTURES."""
import pathlib
import sys

from browser import Browser

SHOWN = ["index.html", "character.html", "engine.html", "cinch.html", "cinch.Refitter.html", "scenes.html",
         "records.html", "glossary.html", "headers.html", "proven.html", "cpp/index.html", "cpp/cinch_8h.html",
         "cpp/annotated.html", "cpp/classcinch_1_1ClipBounder.html"]
GROUND = "return getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3).reduce((a, b) => a + +b, 0)"


def command(browser, name, **parameters):
    return browser.call("POST", "/goog/cdp/execute", {"cmd": f"Emulation.{name}", "params": parameters})


def screen(browser, width, scheme):
    command(browser, "setDeviceMetricsOverride", width=width, height=1400, deviceScaleFactor=1, mobile=width < 500)
    command(browser, "setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])


def look(browser, site, page):
    browser.open(site / page)
    wide = browser.run("return document.documentElement.scrollWidth - innerWidth")
    assert wide <= 0, f"{page}: {wide} pixels wider than the screen"
    said = browser.console()
    assert not said, f"{page}: {said[0]['message']}"
    for address in browser.requests():
        assert address.startswith((site.as_uri(), "data:")), f"{page} asks for {address}"


def main(site, pictures):
    site, pictures = pathlib.Path(site).resolve(), pathlib.Path(pictures)
    pictures.mkdir(parents=True, exist_ok=True)
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    assert set(SHOWN) <= set(pages), set(SHOWN) - set(pages)
    with Browser(1100, 900, webgl=False) as browser:
        for width, scheme in ((390, "light"), (1100, "dark"), (1400, "light")):
            screen(browser, width, scheme)
            for page in pages if width == 390 else SHOWN:
                look(browser, site, page)
                ground = browser.run(GROUND)
                assert (ground < 200) if scheme == "dark" else (ground > 600), f"{page}: {scheme}, but {ground}"
                if page in SHOWN:
                    browser.settle()
                    name = f"site-{page.replace('/', '-').removesuffix('.html')}-{width}-{scheme}.png"
                    (pictures / name).write_bytes(browser.picture())

        screen(browser, 1100, "light")
        browser.open(site / "index.html")
        for _ in range(3):  # auto, dark, light, auto
            browser.click(".content-icon-container .theme-toggle")
            if browser.run("return document.body.dataset.theme") == "dark":
                assert browser.run(GROUND) < 200, "the switch does not make it dark"
                break
        else:
            raise AssertionError("the switch of the theme does nothing")
        browser.run("localStorage.clear()")

        for place in ("cpp", "c", "python", "command"):
            browser.open(site / "index.html")
            browser.click(f"article a[href='character.html#character-{place}']")
            browser.wait("const e = document.getElementById(arguments[0]), top = e && e.getBoundingClientRect().top;"
                         "return e && top > -50 && top < 700", f"character-{place}", seconds=20)
            assert "Bounds of my character" in browser.run("return document.querySelector('h1').textContent")

        browser.open(site / "proven.html")
        marks = browser.run("return [...document.querySelectorAll('article a[href^=http]')].map("
                            "a => getComputedStyle(a, '::after').content)")
        assert marks and all("↗" in mark for mark in marks), f"links that leave the site do not say so: {marks}"
    print(f"{len(pages)} pages; pictures: {pictures}/site-*.png")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
