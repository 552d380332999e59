"""Same seed and options, same bytes: for every number of threads and order of images."""
import json
import re
import unittest

from support import FAST, CliTest, map_files


class Reproducibility(CliTest):
    def maps_of(self, *options):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST[:-1], *options), 0)
        return map_files(workspace)

    def test_threads_do_not_change_a_byte_and_the_seed_does(self):
        one = self.maps_of("--PatchMatchStereo.num_threads=1")
        self.assertEqual(len(one), 4 * 2 * 2)
        self.assert_same_maps(self.maps_of("--PatchMatchStereo.num_threads=2"), one)
        self.assert_same_maps(self.maps_of("--PatchMatchStereo.num_threads=2"), one)
        # Two images in flight.
        self.assert_same_maps(self.maps_of("--PatchMatchStereo.num_threads=4"), one)
        self.assertTrue(one != self.maps_of("--random_seed=7"))

    def test_neighbours_follow_each_other_whatever_the_order_of_the_cfg(self):
        # A row; the cache holds what one image needs.
        options = [*FAST, "--PatchMatchStereo.cache_size=0.00005"]
        maps, decoded = [], []
        for order in ((0, 1, 2, 3, 4, 5, 6, 7), (3, 0, 7, 4, 1, 6, 2, 5)):
            workspace = self.workspace(views=8)
            names = sorted(path.name for path in (workspace / "images").iterdir())
            sources = {i: [j for j in (i - 1, i + 1) if 0 <= j < 8] for i in range(8)}
            (workspace / "stereo/patch-match.cfg").write_text("".join(
                f"{names[i]}\n{', '.join(names[j] for j in sources[i])}\n" for i in order))
            result = self.run_tool(workspace, *options)
            self.assert_exit(result, 0)
            maps.append(map_files(workspace))
            lines = re.findall(r"Processing view (\d+) / 8 for view0(\d)", result.stdout)
            stages = len(lines) // 8
            self.assertEqual([int(number) for number, _ in lines], [*range(1, 9)] * stages)
            worked = [int(image) for _, image in lines][:8]
            self.assertEqual(worked, [*range(8)] if order[0] == 0 else [3, 4, 5, 6, 7, 2, 1, 0])
            record = json.loads((workspace / "stereo/hpm_mvs/run.json").read_text())
            decoded.append(record["images_decoded"])
        self.assert_same_maps(*maps)
        # Once per stage, but for the neighbours of the image where the row is cut.
        self.assertLessEqual(decoded[1], decoded[0] + 2 * stages)

    def test_a_finished_workspace_is_left_alone_and_overwrite_computes_anew(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        path = workspace / "stereo/depth_maps/view00.png.geometric.bin"
        before = path.stat().st_mtime_ns
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assertEqual(path.stat().st_mtime_ns, before)
        self.assertNotIn("Processing view", result.stdout)
        self.assert_exit(self.run_tool(workspace, *FAST, "--Hpm.overwrite=1"), 0)
        self.assertNotEqual(path.stat().st_mtime_ns, before)

    def test_other_options_do_not_keep_old_maps(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        self.assert_exit(
            self.run_tool(workspace, *FAST, "--PatchMatchStereo.max_image_size=48"), 0
        )
        maps = map_files(workspace)
        self.assertEqual(len(maps), 4 * 2 * 2)
        self.assertTrue(all(data.startswith(b"48&36&") for data in maps.values()))


if __name__ == "__main__":
    unittest.main()
