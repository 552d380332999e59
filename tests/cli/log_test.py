"""What a run says of itself, for people and for programs, and small options around it."""
import json
import unittest

from support import FAST, CliTest, map_files, read_map


class Log(CliTest):
    def test_the_log_begins_with_the_options(self):
        dense = self.workspace()
        result = self.run_tool(dense, *FAST, "--random_seed=7")
        self.assert_exit(result, 0)
        lines = result.stdout.splitlines()
        begin = lines.index("Options:")
        self.assertLess(begin, 3)
        self.assertIn("  random_seed: 7", lines)
        self.assertIn("  PatchMatchStereo.window_radius: 3", lines)
        self.assertLess(lines.index("  random_seed: 7"), lines.index("Reading workspace..."))

    def test_stages_are_named_for_people(self):
        dense = self.workspace()
        result = self.run_tool(dense, *FAST, "--Hpm.num_levels=2")
        self.assert_exit(result, 0)
        self.assertRegex(result.stdout, r"(?m)^\[ *\d+%\] searching at half size, pass 1 of \d: image 1/4")
        self.assertRegex(result.stdout, r"(?m)^\[100%\] making images agree at full size, pass (\d) of \1: image 4/4")
        self.assertIn("Processing view 1 / 4 for view00.png (searching at half size, pass 1 of", result.stdout)

    def test_json_is_one_object_a_line_with_the_documented_members(self):
        dense = self.workspace()
        (dense / "images/view02.png").write_bytes(b"")
        result = self.run_tool(dense, *FAST, "--Hpm.log_format=json")
        self.assertEqual((result.returncode, result.stderr), (4, ""))
        events = [json.loads(line) for line in result.stdout.splitlines()]
        by_kind = {}
        for event in events:
            self.assertGreaterEqual(event["time"], 0)
            by_kind.setdefault(event["event"], []).append(event)
        self.assertEqual(set(by_kind), {"options", "message", "progress", "result"})
        result = events[-1]
        self.assertEqual(
            {name: result[name] for name in ("event", "exit_code", "images", "computed", "kept", "failed")},
            {"event": "result", "exit_code": 4, "images": 4, "computed": 3, "kept": 0, "failed": ["view02.png"]},
        )
        self.assertTrue(0 < result["valid_pixel_share"] <= 1)
        (options,) = by_kind["options"]
        self.assertEqual(options["options"]["PatchMatchStereo.window_radius"], 3)
        levels = {m["level"]: m["message"] for m in by_kind["message"]}
        self.assertEqual(set(levels), {"info", "warning", "error"})
        self.assertIn("1 of 4 images failed: view02.png", levels["error"])
        last = by_kind["progress"][-1]
        self.assertEqual((last["stage"], last["image"], last["fraction"]), ("geometric", "", 1))
        self.assertEqual(last["image_number"], last["num_images"])
        fractions = [event["fraction"] for event in by_kind["progress"]]
        self.assertEqual(fractions, sorted(fractions))


class Photometric(CliTest):
    def test_photometric_maps_are_left_out_when_asked_and_the_others_are_the_same(self):
        dense = self.workspace()
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        with_all = map_files(dense)
        other = self.workspace()
        options = [*FAST, "--Hpm.keep_photometric=0"]
        self.assert_exit(self.run_tool(other, *options), 0)
        expected = {n: d for n, d in with_all.items() if ".photometric." not in n}
        self.assert_same_maps(map_files(other), expected)
        self.assertEqual(list((other / "stereo/hpm_mvs").rglob("*.bin")), [])
        self.assertIn("4 kept", self.run_tool(other, *options).stdout)
        # Asked for later, they are made.
        self.assert_exit(self.run_tool(other, *FAST), 0)
        self.assert_same_maps(map_files(other), with_all)

    def test_without_geometry_they_are_the_result(self):
        dense = self.workspace()
        options = [*FAST, "--Hpm.keep_photometric=0", "--PatchMatchStereo.geom_consistency=0"]
        self.assert_exit(self.run_tool(dense, *options), 0)
        self.assertEqual(len(map_files(dense)), 8)


class DepthRanges(CliTest):
    def depths(self, dense, name):
        values = read_map(dense / f"stereo/depth_maps/{name}.geometric.bin")[3]
        return [d for d in values if d > 0]

    def test_ranges_of_single_images_go_before_the_rest(self):
        dense = self.workspace()
        self.assert_exit(self.run_tool(dense, *FAST), 0)
        depths = sorted(self.depths(dense, "view01.png"))
        near, far = depths[len(depths) // 4], depths[3 * len(depths) // 4]
        ranges = dense.parent / "ranges.txt"
        ranges.write_text(f"# by hand\n\nview01.png {near} {far}\n")
        options = [*FAST, f"--Hpm.depth_ranges={ranges}"]
        result = self.run_tool(dense, *options)
        self.assert_exit(result, 0)
        kept = self.depths(dense, "view01.png")
        self.assertGreater(len(kept), len(depths) / 4)
        self.assertTrue(near <= min(kept) and max(kept) <= far)
        others = self.depths(dense, "view00.png")
        self.assertFalse(near <= min(others) and max(others) <= far)
        self.assertIn("4 kept", self.run_tool(dense, *options).stdout)

    def test_lines_that_are_no_range_are_exit_3_with_file_and_line(self):
        dense = self.workspace()
        ranges = dense.parent / "ranges.txt"
        options = [*FAST, f"--Hpm.depth_ranges={ranges}"]
        for line, word in (
            ("view01.png 3", "IMAGE NEAR FAR"),
            ("view01.png 3 2", "IMAGE NEAR FAR"),
            ("view01.png 0 0", "IMAGE NEAR FAR"),
            ("view01.png 1 nan", "IMAGE NEAR FAR"),
            ("view09.png 1 2", "no image 'view09.png'"),
            ("view00.png 1 2", "a second range"),
        ):
            ranges.write_text(f"view00.png 1 2\n{line}\n")
            self.assert_exit(self.run_tool(dense, *options), 3, "ranges.txt", "2", word)
        ranges.unlink()
        self.assert_exit(self.run_tool(dense, *options), 3, "ranges.txt")
        self.assertEqual(map_files(dense), {})


if __name__ == "__main__":
    unittest.main()
