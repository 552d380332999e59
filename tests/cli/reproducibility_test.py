"""Same seed and options, same bytes: for every number of threads."""
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
