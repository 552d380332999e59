"""COLMAP's own programs take our maps (docs: the replacement's acceptance test)."""
import re
import statistics
import struct
import subprocess
import unittest

from support import FAST, CliTest, map_files, read_map

# tests/scenes: the plane through the origin with this normal, toward the cameras.
LENGTH = (0.3**2 + 0.4**2 + 1) ** 0.5
NORMAL = (0.3 / LENGTH, -0.4 / LENGTH, -1 / LENGTH)


def colmap(*arguments):
    return subprocess.run(
        ["colmap", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=True,
        timeout=120,
    ).stdout


def fuse(workspace, stage, *options):
    ply = workspace / f"fused_{stage}.ply"
    colmap(
        "stereo_fusion", "--workspace_path", workspace, "--output_path", ply,
        "--input_type", stage, "--StereoFusion.num_threads", 1, *options,
    )
    data = ply.read_bytes()
    count = int(re.search(rb"element vertex (\d+)", data).group(1))
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    return [struct.unpack_from("<6f3B", data, begin + 27 * i) for i in range(count)]


class Acceptance(CliTest):
    def assert_on_plane(self, points, at_least):
        self.assertGreater(len(points), at_least)
        distances = [abs(sum(p[k] * NORMAL[k] for k in range(3))) for p in points]
        slopes = [sum(p[3 + k] * NORMAL[k] for k in range(3)) for p in points]
        # The cameras are 5 units away; a pixel is 0.026 units wide there.
        self.assertLess(statistics.median(distances), 0.01)
        self.assertLess(sorted(distances)[int(0.95 * len(points))], 0.05)
        self.assertGreater(min(slopes), 0, "a normal points away from the cameras")
        self.assertGreater(statistics.median(slopes), 0.98)

    def test_fusion_of_both_kinds_of_maps_gives_points_on_the_plane(self):
        workspace = self.workspace(views=6, width=160, height=120)
        self.assert_exit(self.run_tool(workspace), 0)
        self.assert_complete(workspace)
        self.assert_on_plane(fuse(workspace, "geometric"), at_least=3000)
        self.assert_on_plane(fuse(workspace, "photometric"), at_least=3000)

    def test_shrunk_images_fuse_too(self):
        workspace = self.workspace(views=6, width=160, height=120)
        result = self.run_tool(
            workspace, "--PatchMatchStereo.max_image_size=120", "--Hpm.previews=1"
        )
        self.assert_exit(result, 0)
        width, height, _, _ = read_map(workspace / "stereo/depth_maps/view00.png.geometric.bin")
        self.assertEqual((width, height), (120, 90))
        self.assert_on_plane(fuse(workspace, "geometric"), at_least=1500)
        self.assertTrue(list((workspace / "stereo/previews").iterdir()))

    def test_only_photometric_maps_without_geometric_consistency(self):
        workspace = self.workspace()
        result = self.run_tool(workspace, *FAST, "--PatchMatchStereo.geom_consistency", "false")
        self.assert_exit(result, 0)
        self.assert_complete(workspace, stages=["photometric"])
        self.assertFalse([name for name in map_files(workspace) if "geometric" in name])
        self.assertEqual(result.stderr.count("geom_consistency 0"), 1)
        self.assertIn("get no priors", result.stderr)

    def test_consistency_graphs_are_whole_and_name_other_images(self):
        workspace = self.workspace()
        result = self.run_tool(workspace, *FAST, "--PatchMatchStereo.write_consistency_graph=1")
        self.assert_exit(result, 0)
        data = (workspace / "stereo/consistency_graphs/view01.png.geometric.bin").read_bytes()
        self.assertTrue(data.startswith(b"96&72&1&"))
        values = struct.unpack(f"<{(len(data) - 8) // 4}i", data[8:])
        i = num_pixels = 0
        while i < len(values):
            col, row, count = values[i : i + 3]
            self.assertTrue(0 <= col < 96 and 0 <= row < 72 and 0 < count <= 3)
            self.assertTrue(set(values[i + 3 : i + 3 + count]) <= {0, 2, 3})
            i += 3 + count
            num_pixels += 1
        self.assertGreater(num_pixels, 1000)

    def test_text_model_gives_the_same_maps(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        binary = map_files(workspace)
        other = self.workspace()
        colmap(
            "model_converter", "--input_path", other / "sparse", "--output_path", other / "sparse",
            "--output_type", "TXT",
        )
        for path in (other / "sparse").glob("*.bin"):
            path.unlink()
        # COLMAP writes the images in any order, two lines each.
        path = other / "sparse/images.txt"
        lines = [l for l in path.read_text().splitlines() if not l.startswith("#")]
        pairs = sorted(zip(lines[::2], lines[1::2]), key=lambda pair: int(pair[0].split()[0]))
        path.write_text("".join(f"{a}\n{b}\n" for a, b in pairs))
        self.assert_exit(self.run_tool(other, *FAST), 0)
        self.assert_same_maps(map_files(other), binary)

    def test_pmvs_workspace(self):
        workspace = self.workspace(views=5)
        out = workspace / "out"
        colmap(
            "image_undistorter", "--image_path", workspace / "images",
            "--input_path", workspace / "sparse", "--output_path", out, "--output_type", "PMVS",
        )
        result = self.run_tool(out / "pmvs", *FAST, "--workspace_format", "pmvs")
        self.assert_exit(result, 0)
        maps = map_files(out / "pmvs", "stereo-option-all")
        self.assertEqual(len(maps), 5 * 2 * 2)
        colmap(
            "stereo_fusion", "--workspace_path", out / "pmvs", "--workspace_format", "PMVS",
            "--output_path", out / "fused.ply", "--StereoFusion.num_threads", 1,
        )
        self.assertIn(b"element vertex", (out / "fused.ply").read_bytes()[:200])


if __name__ == "__main__":
    unittest.main()
