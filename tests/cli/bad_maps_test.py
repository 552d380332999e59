"""Damaged maps in a workspace count as absent: the next run makes them anew."""
import unittest

from support import FAST, CliTest, map_files


class BadMaps(CliTest):
    def test_every_damaged_map_is_recomputed_to_the_same_bytes(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        good = map_files(workspace)
        header_length = len(b"96&72&1&")
        faults = [
            lambda data: b"",
            lambda data: data[:5],
            lambda data: data[:header_length],
            lambda data: data[:2000],
            lambda data: data[:-1],
            lambda data: data + b"\0",
            lambda data: b"-96&-72&1&" + data[header_length:],
            lambda data: b"0&0&0&",
            lambda data: b"4000000000&4000000000&3&" + data[header_length:],
            lambda data: b"9" * 100000,
            lambda data: b"96 72 1 " + data[header_length:],
            lambda data: b"not a map at all",
            lambda data: b"   " + data,
            lambda data: b"72&96&1&" + data[header_length:],
            lambda data: b"96&72&2&" + data[header_length:],
            lambda data: b"&&&",
        ]
        self.assertEqual(len(good), len(faults))
        for (name, data), fault in zip(good.items(), faults):
            (workspace / "stereo" / name).write_bytes(fault(data))
        result = self.assert_rerun_completes(workspace)
        self.assertIn("Processing view", result.stdout)
        self.assertEqual(result.stderr.count("damaged"), 1, result.stderr)
        self.assertIn("16 maps are damaged or were changed by others", result.stderr)
        self.assertIn("depth_maps/view00.png.geometric.bin", result.stderr)
        self.assert_same_maps(map_files(workspace), good)

    def test_a_deleted_map_is_recomputed_and_the_others_are_kept(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        good = map_files(workspace)
        kept = workspace / "stereo/depth_maps/view00.png.geometric.bin"
        time_of_kept = kept.stat().st_mtime_ns
        (workspace / "stereo/normal_maps/view02.png.geometric.bin").unlink()
        self.assert_rerun_completes(workspace)
        self.assert_same_maps(map_files(workspace), good)
        self.assertEqual(kept.stat().st_mtime_ns, time_of_kept)

    def test_a_link_under_a_final_name_is_replaced_not_followed(self):
        workspace = self.workspace()
        canary = workspace.parent / "canary"
        canary.write_text("alive")
        for kind in ("depth_maps", "normal_maps"):
            for stage in ("photometric", "geometric"):
                (workspace / "stereo" / kind / f"view01.png.{stage}.bin").symlink_to(canary)
        self.assert_rerun_completes(workspace)
        self.assertEqual(canary.read_text(), "alive")


if __name__ == "__main__":
    unittest.main()
