"""The report of a run in a real browser: it complains about nothing, asks nobody for
anything, shows all images under their names, and sorts. Exit code 77: no browser."""
import shutil
import subprocess
import sys
import tempfile

import devtools

if devtools.browser() is None:
    print(f"skipped: none of {', '.join(devtools.BROWSERS)} found; "
          "scripts/install_dependencies.sh --browser installs Chromium", file=sys.stderr)
    sys.exit(77)

import unittest

import png
import sparse_patch
from support import FAST, HPM_MVS, TIME_FACTOR, CliTest

ODD_NAME = "<b>&.png"

# Rows of the table as a reader sees them: their cells' texts.
ROWS = "[...document.querySelectorAll('#images tbody tr')].map(r => [...r.cells].map(c => c.innerText))"
# What a column is sorted by, row by row.
KEYS = ("[...document.querySelectorAll('#images tbody tr')]"
        ".map(r => r.cells[{}].getAttribute('data-v'))")
# Sizes of all pictures once they are decoded, those below the fold, too.
PICTURES = """Promise.all([...document.images].map(async image => {
  image.loading = 'eager';
  await image.decode();
  return [image.naturalWidth, image.naturalHeight, image.clientWidth, image.clientHeight];
}))"""


class ReportInABrowser(CliTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.profile = tempfile.mkdtemp(prefix="hpm_browser_")
        cls.page = devtools.Page(cls.profile, 60 * TIME_FACTOR)

    @classmethod
    def tearDownClass(cls):
        cls.page.__exit__()
        shutil.rmtree(cls.profile, ignore_errors=True)

    def run_report(self, dense):
        return subprocess.run([HPM_MVS, "report", "--workspace_path", str(dense)],
                              capture_output=True, text=True, timeout=120)

    def open_report(self, dense):
        self.page.open((dense / "stereo/report.html").as_uri())

    def workspace_with_an_odd_name(self):
        dense = self.workspace()
        sparse_patch.rename_image(dense / "sparse/images.bin", 1, ODD_NAME.encode())
        for cfg in ("patch-match.cfg", "fusion.cfg"):
            path = dense / "stereo" / cfg
            path.write_text(path.read_text().replace("view01.png", ODD_NAME))
        (dense / "images/view01.png").rename(dense / "images" / ODD_NAME)
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        return dense

    def test_it_shows_all_images_and_needs_nothing_else(self):
        dense = self.workspace_with_an_odd_name()
        self.open_report(dense)
        rows = self.page.value(ROWS)
        self.assertEqual(sorted(row[0].split("\n")[0] for row in rows),
                         [ODD_NAME, "view00.png", "view02.png", "view03.png"])
        self.assertEqual(self.page.value("document.querySelectorAll('b').length"), 0)
        pictures = self.page.value(PICTURES)
        self.assertEqual(len(pictures), 3 * len(rows))
        for sizes in pictures:
            self.assertGreater(min(sizes), 20)
        own = (dense / "stereo/report.html").as_uri()
        self.assertEqual([url for url in self.page.requests
                          if url != own and not url.startswith("data:image/jpeg;base64,")], [])
        self.assertEqual(self.page.errors, [])

    def test_every_heading_sorts(self):
        dense = self.workspace_with_an_odd_name()
        # An image without maps has no numbers to be sorted by.
        for folder in ("depth_maps", "normal_maps"):
            (dense / f"stereo/{folder}/view02.png.geometric.bin").unlink()
        self.assert_exit(self.run_report(dense), 0)
        self.open_report(dense)
        num_columns = self.page.value("document.querySelectorAll('#images th').length")
        self.assertGreater(num_columns, 8)
        self.assertEqual(num_columns, self.page.value("document.querySelector('#images tbody tr').cells.length"))
        for column in range(num_columns):
            orders = []
            for _ in range(2):
                self.page.value(f"document.querySelectorAll('#images th')[{column}].click()")
                orders.append(self.page.value(KEYS.format(column)))
            up, down = orders if column == 0 else [[float(key) for key in keys] for keys in orders]
            self.assertEqual(up, sorted(up), f"column {column}")
            self.assertEqual(down, up[::-1], f"column {column}")
            self.assertEqual(self.page.value(ROWS + ".length"), 4)
        self.assertEqual(self.page.errors, [])

    def test_pictures_and_bars_are_painted(self):
        self.open_report(self.workspace_with_an_odd_name())
        self.page.value(PICTURES)
        for selector in ("#images tbody tr", "h2 + svg", "p + svg"):
            width, height, channels, data = png.decode(self.page.screenshot(selector))
            colors = {data[i : i + channels] for i in range(0, len(data), channels)}
            self.assertGreater(width * height, 1000)
            self.assertGreater(len(colors), 2 if "svg" in selector else 20, selector)

    def test_a_window_of_1200_pixels_shows_all_columns(self):
        dense = self.workspace(views=3, width=288, height=144)
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        self.open_report(dense)
        self.page.value(PICTURES)
        self.assertLessEqual(*self.page.value(
            "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"))

    def test_a_page_that_does_otherwise_would_be_noticed(self):
        path = self.workspace().parent / "page.html"
        path.write_text("<img src='http://127.0.0.1:9/a.png'><script>throw 1</script>"
                        "<table id=images><tr><td>blank</table>")
        self.page.open(path.as_uri())
        self.assertIn("http://127.0.0.1:9/a.png", self.page.requests)
        self.assertGreaterEqual(len(self.page.errors), 2)

    def test_the_page_forbids_requests_to_anywhere(self):
        dense = self.workspace()
        self.assert_exit(self.run_report(dense), 0)
        path = dense / "stereo/report.html"
        path.write_text(path.read_text().replace(
            "</body>", "<img src='http://127.0.0.1:9/a.png'></body>"))
        self.open_report(dense)
        self.assertTrue(any("Content Security Policy" in error for error in self.page.errors),
                        self.page.errors)


if __name__ == "__main__":
    unittest.main()
