# SPDX-License-Identifier: GPL-3.0-or-later
"""What there is in a folder of pages, read with the standard library alone."""
import html.parser
import pathlib
import posixpath
import re
import urllib.parse
import zlib

RESOURCES = {"script": "src", "img": "src", "iframe": "src", "source": "src", "embed": "src", "audio": "src",
             "video": "src", "track": "src", "object": "data", "form": "action", "use": "href"}


class Page(html.parser.HTMLParser):
    """ids, links [(address, text)], resources [address], h1, text, what is said of [id of a <dt>] in its <dd>."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.resources, self.h1, self.said = set(), [], [], "", {}
        self.styles, self.inside, self.terms, self.words = [], [], [], []
        self.feed(text)
        self.text = " ".join("".join(self.words).split())

    def handle_starttag(self, tag, pairs):
        given = dict(pairs)
        self.ids.update(given[name] for name in ("id", "name") if given.get(name))
        if tag == "a" and given.get("href"):
            self.links.append([given["href"], ""])
        elif tag == "link" and given.get("href"):
            self.resources.append(given["href"])
        elif tag in RESOURCES and given.get(RESOURCES[tag]):
            self.resources.append(given[RESOURCES[tag]])
        if given.get("srcset"):
            self.resources += [part.split()[0] for part in given["srcset"].split(",")]
        if given.get("style"):
            self.styles.append(given["style"])
        if tag == "dt" and given.get("id"):
            self.terms.append(given["id"])
            self.said[given["id"]] = ""
        if tag in ("a", "h1", "dt", "dd", "style", "script"):
            self.inside.append(tag)

    def handle_endtag(self, tag):
        if tag in self.inside:
            while self.inside.pop() != tag:
                pass

    def handle_data(self, data):
        if "style" in self.inside:
            self.styles.append(data)
        if "style" in self.inside or "script" in self.inside:
            return
        self.words.append(data)
        if "a" in self.inside and self.links:
            self.links[-1][1] += data
        if "h1" in self.inside:
            self.h1 += data
        if self.terms and next((tag for tag in reversed(self.inside) if tag in ("dt", "dd")), "") == "dd":
            self.said[self.terms[-1]] += data


class Site:
    """The pages of a folder, by their names in it; `changed` has texts that stand for those of files."""

    def __init__(self, folder, changed=None):
        self.folder = pathlib.Path(folder)
        self.files = {path.relative_to(self.folder).as_posix() for path in self.folder.rglob("*") if path.is_file()}
        self.changed = changed or {}
        self.pages = {name: Page(self.read(name)) for name in sorted(self.files) if name.endswith(".html")}

    def read(self, name):
        return self.changed.get(name) or (self.folder / name).read_text(encoding="utf-8")

    def target(self, page, address):
        """(file, fragment) that an address on a page is of, or None if it is outside."""
        parts = urllib.parse.urlsplit(address)
        if parts.scheme or parts.netloc or parts.path.startswith("/"):
            return None
        path = urllib.parse.unquote(parts.path)
        file = posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page
        return file, urllib.parse.unquote(parts.fragment)

    def styles(self):
        """(name, text) of all that is CSS."""
        for name in sorted(self.files):
            if name.endswith(".css"):
                yield name, self.read(name)
        for name, page in self.pages.items():
            for text in page.styles:
                yield name, text

    def within(self, start, clicks):
        """Pages that so many clicks reach from one."""
        reached = {start}
        for _ in range(clicks):
            for page in list(reached):
                for address, _ in self.pages[page].links:
                    target = self.target(page, address)
                    if target and target[0] in self.pages:
                        reached.add(target[0])
        return reached

    def python_names(self):
        """Name -> page and fragment, of Sphinx's inventory."""
        data = (self.folder / "objects.inv").read_bytes()
        text = zlib.decompress(data.split(b"\n", 4)[4]).decode()
        found = {}
        for line in text.splitlines():
            name, kind, _, address, _ = re.match(r"(.+?) (\S+) (-?\d+) (\S*) (.*)", line).groups()
            if kind.startswith("py:"):
                page, _, fragment = address.replace("$", name).partition("#")
                found[name] = (page, fragment)
        return found
