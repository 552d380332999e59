"""The site is built, each document is a page of it, headers have their reference, and no link
within it is dead. usage: site_test.py FOLDER. Exit code 77: a tool is missing."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import build_site
import doxygen_filter

WORK = pathlib.Path(sys.argv[1])


class Site(unittest.TestCase):
    def test_every_document_is_a_page(self):
        for document in (ROOT / "docs").glob("*.md"):
            self.assertTrue((WORK / "site" / f"{document.stem}.html").is_file(), document.name)

    def test_the_reference_has_what_a_program_calls(self):
        names = "\n".join(path.name for path in (WORK / "site/api").rglob("*.html"))
        for name in ("PatchMatchController", "Backend", "Error"):
            self.assertRegex(names, rf"classhpm_1_1{name}\.html")
        # Comments in front of a function become its text.
        header = (ROOT / "src/engine/backend.h").read_text(encoding="utf-8")
        comment = re.search(r"\n\n  // ((?:[\w,]+ ){3})", header)[1].strip()
        page = (WORK / "site/api/classhpm_1_1Backend.html").read_text(encoding="utf-8")
        self.assertTrue(f"<p>{comment}" in page, comment)

    def test_nothing_is_loaded_from_elsewhere(self):
        for path in (WORK / "site").rglob("*.html"):
            text = path.read_text(encoding="utf-8")
            loaded = re.findall(r"<(?:script|img|iframe)[^>]*\ssrc=\"(?:https?:)?//[^\"]*", text)
            loaded += re.findall(r"<link[^>]*rel=\"(?:stylesheet|preconnect)\"[^>]*href=\"(?:https?:)?//[^\"]*", text)
            self.assertEqual(loaded, [], path)


class TheBuilder(unittest.TestCase):
    def test_finds_dead_links_and_anchors(self):
        with tempfile.TemporaryDirectory() as folder:
            site = pathlib.Path(folder).resolve()
            (site / "a.html").write_text(
                '<h1 id="here"></h1><a href="#here"></a><a href="b.html#there"></a><a href="b.html"></a>')
            (site / "b.html").write_text(
                '<a id="there"></a><a href="a.html#gone"></a><img src="gone.png"><a href="gone.html"></a>'
                '<a href="https://example.org/"></a>')
            self.assertEqual(build_site.dead_links(site),
                             ["b.html: a.html#gone", "b.html: gone.html", "b.html: gone.png"])

    def test_makes_links_of_named_documents(self):
        self.assertEqual(build_site.with_links("see `docs/gpu.md` and `README.md`, not `docs/none.md`"),
                         "see [`docs/gpu.md`](gpu.md) and [`README.md`](index.md), not `docs/none.md`")
        code = "```sh\ncat `docs/gpu.md`\n```"
        self.assertEqual(build_site.with_links(code), code)

    def test_comments_become_documentation(self):
        self.assertEqual(
            doxygen_filter.for_doxygen('// A thing.\n#pragma once\nint a;  // of use\nauto b = "//";\n'),
            '/// \\file\n/// A thing.\n#pragma once\nint a;  ///< of use\nauto b = "//";\n')


if __name__ == "__main__":
    status = subprocess.run([sys.executable, ROOT / "scripts/build_site.py", WORK]).returncode
    if status != 0:
        sys.exit(status)
    unittest.main(argv=sys.argv[:1])
