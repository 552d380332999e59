#!/usr/bin/env python3
"""The documents as a site: docs/ and the papers beside it by mkdocs-material, the reference of
the installed headers by Doxygen, every link within the site checked.

    scripts/install_site.sh && scripts/install_dependencies.sh --release
    scripts/build_site.py [build/site]

Exit code 77 when mkdocs or Doxygen is missing, 1 when a link leads nowhere. The site loads
nothing from anywhere else.
"""
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[1]
MKDOCS = ROOT / ".site-venv/bin/mkdocs"

# Papers outside of docs/ and the pages they become.
PAPERS = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "patches/README.md": "patches.md",
    "data/README.md": "data.md",
}
# Pages in the order in which they are of use; others of docs/ follow under "More".
SECTIONS = {
    "Use": ["installing", "tutorial", "holes", "options", "python", "reliability", "patches", "changelog"],
    "Method and figures": ["algorithm", "benchmarks", "ablation", "experiments", "gpu", "data"],
    "Work on it": ["contributing", "architecture", "systems", "security"],
}
# Of the folders that cmake/hpm_install.cmake installs.
DOXYFILE = """
PROJECT_NAME = hpm_mvs
PROJECT_NUMBER = {version}
OUTPUT_DIRECTORY = {work}
HTML_OUTPUT = api
GENERATE_LATEX = NO
INPUT = src colmap_plugin cuda/cuda_backend.h cuda/cuda_devices.h
RECURSIVE = YES
FILE_PATTERNS = *.h
EXCLUDE_PATTERNS = */in_colmap/* */wrapper/* *_windows.h
INPUT_FILTER = "{python} {root}/scripts/doxygen_filter.py"
FILTER_SOURCE_FILES = NO
STRIP_FROM_PATH = {root}
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
HAVE_DOT = NO
SEARCHENGINE = NO
VERBATIM_HEADERS = NO
HTML_TIMESTAMP = NO
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_DOC_ERROR = NO
"""

# Made by the tools: the theme's for keyboards on a page without a heading, Doxygen's for
# nested classes that are private.
NO_ANCHORS = ("__skip", "nested-classes")


def page_name(path):
    """The page that a document of the repository becomes, None if it is none."""
    if path in PAPERS:
        return PAPERS[path] if (ROOT / path).exists() else None
    match = re.fullmatch(r"docs/(\w+\.md)", path)
    return match.group(1) if match and (ROOT / path).exists() else None


def with_links(text):
    """`docs/gpu.md` in a text becomes a link to that page, outside of code blocks."""
    def link(match):
        page = page_name(match.group(1))
        return f"[{match.group(0)}]({page})" if page else match.group(0)

    parts = re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)
    parts[::2] = [re.sub(r"(?<!\[)`([\w/]+\.md)`", link, part) for part in parts[::2]]
    return "".join(parts)


def assemble(pages):
    """Copies documents and pictures; returns the names of the pages."""
    shutil.copytree(ROOT / "docs", pages)
    for path, page in PAPERS.items():
        if (ROOT / path).exists():
            text = (ROOT / path).read_text(encoding="utf-8")
            (pages / page).write_text(text.replace("](docs/", "]("), encoding="utf-8")
    for page in pages.glob("*.md"):
        page.write_text(with_links(page.read_text(encoding="utf-8")), encoding="utf-8")
    return sorted(page.stem for page in pages.glob("*.md"))


def navigation(names):
    nav = [{"Home": "index.md"}]
    known = {"index"}
    for title, pages in SECTIONS.items():
        nav.append({title: [f"{name}.md" for name in pages if name in names]})
        known.update(pages)
    rest = [f"{name}.md" for name in names if name not in known]
    if rest:
        nav.append({"More": rest})
    return nav + [{"Headers": "api/index.html"}]


def build(work):
    pages, site = work / "pages", work / "site"
    names = assemble(pages)
    version = (ROOT / "VERSION").read_text().strip()
    doxyfile = work / "Doxyfile"
    doxyfile.write_text(DOXYFILE.format(version=version, work=pages, root=ROOT, python=sys.executable))
    subprocess.run(["doxygen", doxyfile], cwd=ROOT, check=True)
    config = work / "mkdocs.yml"  # JSON is YAML
    config.write_text(json.dumps({
        "site_name": f"HPM-MVS for COLMAP {version}",
        "docs_dir": str(pages), "site_dir": str(site), "use_directory_urls": False,
        # Fonts of the reader's own machine: nothing is loaded from elsewhere.
        "theme": {"name": "material", "font": False, "features": ["navigation.sections", "content.code.copy"]},
        "markdown_extensions": ["tables", "admonition", {"toc": {"permalink": True}}, "pymdownx.superfences"],
        "nav": navigation(names),
        "validation": {"links": {"anchors": "warn"}},
    }))
    subprocess.run([MKDOCS, "build", "--strict", "--quiet", "--config-file", config], check=True,
                   env={**os.environ, "NO_MKDOCS_2_WARNING": "1"})
    return site


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8", errors="replace"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.add(value)
            elif value and (name == "src" or (name == "href" and tag in ("a", "link"))):
                self.links.append(value)


def dead_links(site):
    """"page: link" of all that lead nowhere, or out of the site for something to load."""
    pages = {path: Page(path) for path in site.rglob("*.html")}
    found = set()
    for path, page in pages.items():
        for link in page.links:
            url = urllib.parse.urlsplit(link)
            if url.scheme or url.netloc:
                continue  # others' sites come and go
            target = path
            if url.path:
                base = site if url.path.startswith("/") else path.parent
                target = (base / urllib.parse.unquote(url.path).lstrip("/")).resolve()
                if target.is_dir():
                    target /= "index.html"
            anchor = urllib.parse.unquote(url.fragment)
            known = pages.get(target)
            if not target.exists() or (anchor and known and anchor not in known.anchors
                                       and anchor not in NO_ANCHORS):
                found.add(f"{path.relative_to(site)}: {link}")
    return sorted(found)


def main():
    work = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/site").resolve()
    for tool, there in (("mkdocs: scripts/install_site.sh", MKDOCS.exists()),
                        ("doxygen: scripts/install_dependencies.sh --release", shutil.which("doxygen"))):
        if not there:
            print(f"skipped: no {tool} installs it", file=sys.stderr)
            return 77
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    site = build(work)
    dead = dead_links(site)
    for link in dead:
        print(f"dead link: {link}", file=sys.stderr)
    print(f"{site}: {len(list(site.rglob('*.html')))} pages, {len(dead)} dead links")
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
