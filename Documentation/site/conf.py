# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's configuration: the pages as they stand in the repository, README first, with the index by question as menu.
Run by Documentation/make_site.sh."""
import importlib.util
import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parents[2]
INDEX = "Documentation/README"

project = "avian-lidar"
author = "the authors of avian-lidar"
copyright = re.search(r"Copyright \(c\) (.*)", (SOURCE / "LICENSE").read_text(encoding="utf-8"))[1]
version = release = re.search(r"project\(\s*AvianLidar\s+VERSION\s+([\d.]+)", (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "README"
include_patterns = ["*.md", "Documentation/*.md", "Documentation/*/*.md", "Testing/*/README.md", "Examples/*/README.md", "Examples/airport/scene/*.md"]
exclude_patterns = ["build", ".git"]  # are not looked through
myst_enable_extensions = ["html_image"]
myst_heading_anchors = 5
highlight_language = "none"
html_theme = "sphinx_rtd_theme"
html_title = f"avian-lidar {version}"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_search_summary = False  # it would ask for pages, which a browser refuses of a file
autodoc_member_order = "bysource"

HAS_PACKAGE = importlib.util.find_spec("avianlidar") is not None
if HAS_PACKAGE:
    include_patterns.append("Documentation/site/api.rst")


def menu(found):
    """The index's parts as lists of pages, each page once, then what no question leads to."""
    seen, lists = {root_doc}, []
    for part in f"Begin [](README.md) {(SOURCE / INDEX).with_suffix('.md').read_text(encoding='utf-8')}".split("\n## "):
        pages = []
        for link in re.findall(r"\]\(([\w./-]+)\.md", part):
            name = str((SOURCE / INDEX).parent.joinpath(link).resolve().relative_to(SOURCE))
            if name not in seen:
                seen.add(name)
                pages.append(name)
        lists.append((part.split("\n")[0] if lists else "Begin", pages))
    return [*lists, ("More", sorted(found - seen))]


def add_menu(app, name, text):
    """The front page brings the menu, which the file in the repository has not."""
    if name == root_doc:
        for caption, pages in menu(app.env.found_docs):
            entries = "\n".join(f"/{page}" for page in pages)
            text[0] += f"\n\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{entries}\n```\n"


def keep_lines(_, what, name, thing, options, lines):
    """The package's texts as help() shows them."""
    lines[:] = ["::", "", *(f"    {line}" for line in lines), ""]


def setup(app):
    app.connect("source-read", add_menu)
    app.connect("autodoc-process-docstring", keep_lines)
