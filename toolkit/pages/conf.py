# SPDX-License-Identifier: Apache-2.0
"""Of Sphinx, which write_sources.py has made the sources for. Beside what it knows: {api}`cinch::Refitter` links to
that in the headers' pages, {api}`text <page.html>` to one of these, and signatures of compiled functions are those of
their stubs."""
import ast
import pathlib
import re
import sys

from docutils import nodes
from sphinx.util import logging
from sphinx.util.nodes import split_explicit_title

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]
sys.path.insert(0, str(here))
import reference  # noqa: E402

project = "cinch"
copyright = "The toolkit is under Apache-2.0, all the rest under GPL-3.0-or-later."
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
exclude_patterns = ["project"]
default_role = "py:obj"
smartquotes_action = "D"  # dashes alone
templates_path = [str(here)]
highlight_language = "text"
html_theme = "furo"
html_title = "cinch"
html_static_path = [str(here / "site.css")]
html_css_files = ["site.css"]
html_show_sphinx = False
html_show_sourcelink = False
html_copy_source = False
html_domain_indices = False
html_theme_options = {"top_of_page_button": None}
pygments_style = "default"
pygments_dark_style = "native"
myst_heading_anchors = 3
autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "undoc-members": True, "special-members": "__call__"}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True


def signatures():
    """Qualified name -> '(a, b=…)', from the stubs."""
    found = {}

    def said(function, bound):
        def one(argument, default):
            return argument.arg + ("=…" if default else "")

        given = function.args
        plain = given.posonlyargs + given.args
        optional = [None] * (len(plain) - len(given.defaults)) + list(given.defaults)
        parts = [one(a, d) for a, d in zip(plain, optional)][1 if bound else 0:]
        if given.vararg:
            parts.append("*" + given.vararg.arg)
        elif given.kwonlyargs:
            parts.append("*")
        parts += [one(a, d) for a, d in zip(given.kwonlyargs, given.kw_defaults)]
        return f"({', '.join(parts)})"

    for module, stub in (("cinch", "toolkit/python/cinch/_core.pyi"),
                         ("cinch.exact", "exact/python/cinch/exact/_exact.pyi")):
        for thing in ast.parse((root / stub).read_text()).body:
            if isinstance(thing, ast.FunctionDef):
                found[f"{module}.{thing.name}"] = said(thing, False)
            elif isinstance(thing, ast.ClassDef):
                for member in thing.body:
                    if isinstance(member, ast.FunctionDef):
                        static = any(getattr(d, "id", "") == "staticmethod" for d in member.decorator_list)
                        name = f"{module}.{thing.name}"
                        found[name if member.name == "__init__" else f"{name}.{member.name}"] = said(member, not static)
    return found


def set_signature(app, what, name, thing, options, signature, returned, known=signatures()):
    return (known.get(name, "()" if what in ("function", "method") else ""), None)


def add_api_role(app):
    known = reference.headers(pathlib.Path(app.srcdir) / "cpp.tag")
    known.update({page.name: f"cpp/{page.name}" for page in (pathlib.Path(app.outdir) / "cpp").glob("*.html")})

    def api(role, raw, text, line, inliner, options={}, content=[]):
        _, title, target = split_explicit_title(text)
        if target not in known:
            logging.getLogger(__name__).warning("no header has '%s'", target,
                                                location=(inliner.document.current_source, line))
        link = nodes.reference(raw, "", refuri=known.get(target, ""), internal=True)
        link += nodes.Text(title) if target.endswith(".html") else nodes.literal(raw, title)
        return [link], []

    app.add_role("api", api)


def drop_dashes(app, tree, page):
    """Behind parameters of whom nothing but their type is said."""
    for paragraph in tree.findall(nodes.paragraph):
        if isinstance(paragraph.parent, (nodes.field_body, nodes.list_item)) and paragraph.children:
            last = paragraph[-1]
            if isinstance(last, nodes.Text) and last.endswith(" \N{EN DASH} "):
                paragraph[-1] = nodes.Text(last[:-3])


def complete_theme(app, fault):
    """Debian's furo imports a style sheet from the host's root, and a script as a module, which files cannot do: both
    are put into the file that wants them. And its compiler lost the rule that 'auto' is what the reader's system is."""
    styles, script = (pathlib.Path(app.outdir) / "_static" / name for name in ("styles/furo.css", "scripts/furo.js"))
    wanted = "@import url(/javascript/normalize.css/normalize.css);"
    text = styles.read_text(encoding="utf-8")
    if wanted in text:
        normal = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css").read_text(encoding="utf-8")
        dark = re.search(r'body\[data-theme="dark"\] (\{[^}]*--color[^}]*\})', text).group(1)
        auto = f"@media screen and (prefers-color-scheme: dark) {{ body[data-theme=auto] {dark} }}"
        styles.write_text(text.replace(wanted, normal) + auto, encoding="utf-8")
    wanted = 'import Gumshoe from "./gumshoe-patched.js";'
    text = script.read_text(encoding="utf-8")
    if wanted in text:
        spy = script.with_name("gumshoe-patched.js").read_text(encoding="utf-8")
        script.write_text(spy + text.replace(wanted, ""), encoding="utf-8")


def setup(app):
    app.connect("autodoc-process-signature", set_signature)
    app.connect("builder-inited", add_api_role)
    app.connect("doctree-resolved", drop_dashes)
    app.connect("build-finished", complete_theme)
