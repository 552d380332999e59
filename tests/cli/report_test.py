"""hpm_mvs report: one file that needs nothing else, with a row for every image, whatever
the images are called."""
import html.parser
import json
import os
import re
import subprocess
import unittest

import sparse_patch
from support import FAST, HPM_MVS, CliTest, read_map


class Page(html.parser.HTMLParser):
    """Rows of the table of images, and all that a page could fetch."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.pictures, self.fetched, self.tags, self.text = [], [], [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.add(tag)
        if tag == "td" and attributes.get("class") == "name":
            self.rows.append(attributes["data-v"])
        for name in ("src", "href", "action"):
            if name in attributes:
                if attributes[name].startswith("data:image/jpeg;base64,"):
                    self.pictures.append(attributes[name])
                else:
                    self.fetched.append(attributes[name])

    def handle_data(self, data):
        self.text.append(data)


class Report(CliTest):
    def report(self, dense, *options):
        return subprocess.run(
            [HPM_MVS, "report", "--workspace_path", str(dense), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
        )

    def page(self, dense):
        text = (dense / "stereo/report.html").read_text(encoding="utf-8")
        return text, Page(text)

    def test_a_run_writes_one_page_that_needs_nothing_else(self):
        dense = self.workspace()
        result = self.run_tool(dense, *FAST)
        self.assert_exit(result, 0)
        self.assertIn("report.html", result.stdout)
        text, page = self.page(dense)
        self.assertEqual(page.rows, [f"view0{i}.png" for i in range(4)])
        self.assertEqual(len(page.pictures), 12)
        self.assertEqual(page.fetched, [])
        for word in ("http:", "https:", "@import", "url("):
            self.assertNotIn(word, text)
        words = " ".join(page.text)
        self.assertNotIn("not known", words)
        for word in ("with depth", "Matching costs", "median", "shared points", "geometry", "Time per phase", "peak memory",
                     "computed on", "max_image_size"):
            self.assertIn(word, words)

    def test_it_is_not_written_when_switched_off_nor_without_a_result(self):
        dense = self.workspace()
        self.assert_exit(self.run_tool(dense, *FAST, "--Hpm.report=0"), 0)
        self.assertFalse((dense / "stereo/report.html").exists())

    def test_a_run_without_work_leaves_the_page_as_it_is(self):
        dense = self.workspace()
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        page = dense / "stereo/report.html"
        before = page.stat().st_mtime_ns
        self.assertNotIn("Report: ", self.run_tool(dense, *FAST).stdout)
        self.assertEqual(page.stat().st_mtime_ns, before)
        page.unlink()
        self.assertIn("Report: ", self.run_tool(dense, *FAST).stdout)
        (dense / "stereo/depth_maps/view00.png.geometric.bin").unlink()
        before = page.stat().st_mtime_ns
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        self.assertNotEqual(page.stat().st_mtime_ns, before)

    def test_names_cannot_become_part_of_the_page(self):
        dense = self.workspace()
        name = "<img src=x onerror=alert(1)>&'\"view.png"
        sparse_patch.rename_image(dense / "sparse/images.bin", 1, name.encode())
        for cfg in ("patch-match.cfg", "fusion.cfg"):
            path = dense / "stereo" / cfg
            path.write_text(path.read_text().replace("view01.png", name))
        (dense / "images/view01.png").rename(dense / "images" / name)
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        text, page = self.page(dense)
        self.assertIn(name, page.rows)
        self.assertEqual(page.fetched, [])
        self.assertNotIn("<img src=x", text)

    def test_costs_are_those_of_the_published_pixels_and_stay_with_the_maps(self):
        dense = self.workspace()
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        record = json.loads((dense / "stereo/hpm_mvs/run.json").read_text())
        for name, stages in record["images"].items():
            depth = read_map(dense / f"stereo/depth_maps/{name}.geometric.bin")[3]
            self.assertEqual(sum(stages["geometric"]["cost_histogram"]), sum(z > 0 for z in depth))
            self.assertNotIn("cost_histogram", stages["photometric"])
        self.assertEqual(record["cost_histogram"], [
            sum(bins) for bins in zip(*(stages["geometric"]["cost_histogram"]
                                        for stages in record["images"].values()))])
        before = self.page(dense)[0]
        # A map that is touched is kept, another one is computed again.
        os.utime(dense / "stereo/depth_maps/view01.png.geometric.bin", (1e9, 1e9))
        (dense / "stereo/depth_maps/view00.png.geometric.bin").unlink()
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        after = self.page(dense)[0]
        self.assertEqual(re.findall("median [0-9.]+", after), re.findall("median [0-9.]+", before))
        # As an older version left them.
        for path in (dense / "stereo/hpm_mvs/stamps").rglob("*view02*"):
            path.write_text(path.read_text().replace("cost_histogram", "costs"))
        self.assert_exit(self.report(dense), 0)
        words = " ".join(self.page(dense)[1].text)
        self.assertEqual(words.count("not known"), 1)
        self.assertIn("Not known of 1 of 4 images", words)

    def test_images_without_maps_and_warnings_are_told(self):
        dense = self.workspace()
        result = self.report(dense)
        self.assert_exit(result, 0)
        _, page = self.page(dense)
        self.assertEqual(len(page.rows), 4)
        self.assertEqual(len(page.pictures), 4)
        self.assertIn("no maps", " ".join(page.text))
        (dense / "images/view02.png").write_bytes(b"")
        self.assert_exit(self.run_tool(dense, *FAST), 4)
        (dense / "stereo/depth_maps/view01.png.geometric.bin").write_bytes(b"rubbish")
        out = dense.parent / "a folder/page.html"
        self.assert_exit(self.report(dense, f"--output_path={out}"), 0)
        words = " ".join(Page(out.read_text()).text)
        self.assertIn("1 of 4 images with a file that cannot be decoded", words)
        self.assertIn("1 images could not be computed, the first: view02.png", words)
        self.assertIn("view01.png.geometric.bin does not begin with", words)


if __name__ == "__main__":
    unittest.main()
