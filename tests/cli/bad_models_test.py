"""Damaged or nonsensical sparse models and configurations."""
import struct
import unittest

import sparse_patch
from support import FAST, CliTest, map_files, read_map

HUGE = struct.pack("<Q", 2**64 - 1)


class DamagedModels(CliTest):
    def assert_refused(self, name, data):
        """Exit 3 with the file's name, and the intact model completes afterwards."""
        path = self.dense / "sparse" / name
        good = path.read_bytes()
        path.write_bytes(data)
        result = self.run_tool(self.dense, *FAST, timeout=20)
        self.assert_exit(result, 3, name)
        self.assertEqual(map_files(self.dense), {})
        path.write_bytes(good)

    def setUp(self):
        self.dense = self.workspace()

    def test_truncated_files_are_exit_3(self):
        for name in ("cameras.bin", "images.bin", "points3D.bin"):
            data = (self.dense / "sparse" / name).read_bytes()
            for length in (0, 7, 9, len(data) // 2, len(data) - 1):
                with self.subTest(name=name, length=length):
                    self.assert_refused(name, data[:length])
        self.assert_rerun_completes(self.dense)

    def test_huge_counts_are_exit_3(self):
        for name in ("cameras.bin", "images.bin", "points3D.bin"):
            with self.subTest(name):
                data = (self.dense / "sparse" / name).read_bytes()
                self.assert_refused(name, HUGE + data[8:])
        data = (self.dense / "sparse/images.bin").read_bytes()
        points = sparse_patch.image_records(data)[1][2]
        self.assert_refused("images.bin", data[:points] + HUGE + data[points + 8 :])
        self.assert_rerun_completes(self.dense)

    def test_an_unterminated_name_is_exit_3(self):
        data = (self.dense / "sparse/images.bin").read_bytes()
        name = sparse_patch.image_records(data)[0][1]
        self.assert_refused("images.bin", data[:name] + b"v" * 5000)

    def test_an_unknown_camera_model_is_exit_3(self):
        data = (self.dense / "sparse/cameras.bin").read_bytes()
        self.assert_refused("cameras.bin", data[:12] + struct.pack("<i", 999) + data[16:])

    def test_a_dangling_camera_and_a_repeated_image_are_exit_3(self):
        data = (self.dense / "sparse/images.bin").read_bytes()
        first, name, _ = sparse_patch.image_records(data)[0]
        camera = name - 4
        self.assert_refused("images.bin", data[:camera] + b"\x63\0\0\0" + data[name:])
        second = sparse_patch.image_records(data)[1][0]
        self.assert_refused("images.bin", data[:second] + data[first : first + 4] + data[second + 4 :])

    def test_a_missing_model_is_exit_3(self):
        for name in ("cameras.bin", "images.bin", "points3D.bin"):
            (self.dense / "sparse" / name).unlink()
        self.assert_exit(self.run_tool(self.dense, *FAST), 3, "sparse")


class ImageNames(CliTest):
    def test_names_that_leave_the_folder_are_exit_3_and_write_nothing_outside(self):
        for name in (b"../../escape.png", b"/tmp/escape.png", b"a/../../b.png", b"", b"a\nb.png"):
            with self.subTest(name):
                workspace = self.workspace()
                sparse_patch.rename_image(workspace / "sparse/images.bin", 1, name)
                before = sorted(p for p in workspace.parent.rglob("*") if p.is_file())
                self.assert_exit(self.run_tool(workspace, *FAST), 3, "name")
                after = sorted(p for p in workspace.parent.rglob("*") if p.is_file())
                self.assertEqual(after, before)

    def test_nested_folders_and_utf8_are_legal(self):
        workspace = self.workspace()
        name = "day 1/Bild ä.png"
        sparse_patch.rename_image(workspace / "sparse/images.bin", 1, name.encode())
        (workspace / "images/day 1").mkdir()
        (workspace / "images/view01.png").rename(workspace / "images" / name)
        cfg = workspace / "stereo/patch-match.cfg"
        cfg.write_text(cfg.read_text().replace("view01.png", name), encoding="utf-8")
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        self.assert_complete(workspace, ["view00.png", name])


class Poses(CliTest):
    def assert_only_this_image_is_left_out(self, workspace):
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assertIn("view01.png", result.stderr)
        self.assert_no_partial_files(workspace)
        self.assert_complete(workspace, ["view00.png", "view02.png", "view03.png"])

    def test_a_pose_or_focal_length_that_is_no_number_leaves_the_image_out(self):
        for value in (float("nan"), float("inf")):
            for index in (0, 4):
                with self.subTest(pose=(index, value)):
                    workspace = self.workspace()
                    path = workspace / "sparse/images.bin"
                    sparse_patch.set_pose_value(path, 1, index, value)
                    self.assert_only_this_image_is_left_out(workspace)

    def test_a_focal_length_that_is_not_positive_leaves_the_image_out(self):
        for value in (0.0, -100.0, float("nan")):
            with self.subTest(focal=value):
                workspace = self.workspace()
                sparse_patch.set_camera_value(workspace / "sparse/cameras.bin", 1, 0, value)
                self.assert_only_this_image_is_left_out(workspace)

    def test_two_images_from_one_place_give_finite_maps(self):
        workspace = self.workspace()
        sparse_patch.copy_pose(workspace / "sparse/images.bin", 0, 1)
        (workspace / "images/view01.png").write_bytes(
            (workspace / "images/view00.png").read_bytes()
        )
        self.assert_rerun_completes(workspace)


class WithoutTracks(CliTest):
    """Models of feed-forward networks and converters: points without tracks, or no points."""

    def depths(self, workspace, name="view02.png"):
        return read_map(workspace / f"stereo/depth_maps/{name}.geometric.bin")[3]

    def valid(self, workspace, name="view02.png"):
        return sum(depth > 0 for depth in self.depths(workspace, name))

    def assert_as_good_as_with_tracks(self, workspace, plain, share=0.8, name="view02.png"):
        same = sum(
            a > 0 and b > 0 and abs(a - b) < 0.02 * b
            for a, b in zip(self.depths(workspace, name), self.depths(plain, name))
        )
        self.assertGreater(same, share * self.valid(plain, name))

    def run_plain(self):
        plain = self.workspace()
        self.assert_rerun_completes(plain)
        return plain

    def test_without_tracks_all_is_computed_and_fusion_is_warned_of_once(self):
        plain = self.run_plain()
        for cfg in ("__auto__, 20", "__all__"):
            for keep_points in (True, False):
                with self.subTest(cfg=cfg, points=keep_points):
                    workspace = self.workspace()
                    if keep_points:
                        sparse_patch.thin_tracks(workspace / "sparse", lambda point, image: False)
                    else:
                        sparse_patch.remove_points(workspace / "sparse")
                    (workspace / "stereo/patch-match.cfg").write_text(
                        "".join(f"view0{i}.png\n{cfg}\n" for i in range(4))
                    )
                    result = self.run_tool(workspace, *FAST)
                    self.assert_exit(result, 0)
                    self.assert_complete(workspace)
                    warnings = [l for l in result.stderr.splitlines() if "stereo_fusion" in l]
                    self.assertEqual(len(warnings), 1, result.stderr)
                    self.assertIn("point_triangulator", warnings[0])
                    self.assertIn("4 reference images", warnings[0])
                    # From poses alone the range is wide, and FAST searches little.
                    share = 0.8 if keep_points else 0.6
                    self.assert_as_good_as_with_tracks(workspace, plain, share)

    def test_an_image_of_few_tracks_stops_nobody_and_suffers_little(self):
        plain = self.run_plain()
        for num_points in (0, 2):
            for cfg in ("__auto__, 20", "__all__"):
                with self.subTest(points=num_points, cfg=cfg):
                    workspace = self.workspace()
                    left = []

                    def keep(point, image):
                        if image != 3:
                            return True
                        left.append(point)
                        return len(left) <= num_points

                    sparse_patch.thin_tracks(workspace / "sparse", keep)
                    (workspace / "stereo/patch-match.cfg").write_text(
                        "".join(f"view0{i}.png\n{cfg}\n" for i in range(4))
                    )
                    result = self.run_tool(workspace, *FAST)
                    self.assert_exit(result, 0)
                    self.assert_complete(workspace)
                    self.assertEqual(result.stderr.count("view02.png"), 1 + (num_points == 0))
                    self.assert_as_good_as_with_tracks(workspace, plain)

    def test_with_a_range_given_nothing_is_estimated(self):
        workspace = self.workspace()
        sparse_patch.remove_points(workspace / "sparse")
        result = self.assert_rerun_completes(
            workspace, *FAST, "--PatchMatchStereo.depth_min=3", "--PatchMatchStereo.depth_max=8"
        )
        self.assertNotIn("estimated", result.stderr)

    def test_where_nothing_tells_the_range_it_is_exit_3_and_says_what_to_give(self):
        workspace = self.workspace()
        sparse_patch.remove_points(workspace / "sparse")
        for image in range(1, 4):
            sparse_patch.copy_pose(workspace / "sparse/images.bin", 0, image)
        (workspace / "stereo/patch-match.cfg").write_text(
            "".join(f"view0{i}.png\n__all__\n" for i in range(4))
        )
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 3, "depth_min", "depth_max")
        self.assert_no_partial_files(workspace)


class Configuration(CliTest):
    def run_with(self, text):
        self.dense = self.workspace()
        data = text if isinstance(text, bytes) else text.encode()
        (self.dense / "stereo/patch-match.cfg").write_bytes(data)
        return self.run_tool(self.dense, *FAST, timeout=60)

    def test_an_unknown_image_is_exit_3_with_file_and_line(self):
        good = "view00.png\n__auto__, 20\n"
        for text in (good + "nowhere.png\n__auto__, 20\n", good + "view01.png\nnowhere.png\n"):
            with self.subTest(text):
                result = self.run_with(text)
                self.assert_exit(result, 3, "patch-match.cfg", "nowhere.png")
                self.assertRegex(result.stderr, r"\b[34]\b")
                self.assertEqual(map_files(self.dense), {})

    def test_numbers_that_are_none_are_exit_3(self):
        for line in ("__auto__", "__auto__, x"):
            with self.subTest(line):
                self.assert_exit(self.run_with(f"view00.png\n{line}\n"), 3, "patch-match.cfg")

    def test_a_line_of_ten_megabytes_is_exit_3_at_once(self):
        result = self.run_with("view00.png\n" + "x" * 10_000_000 + "\n")
        self.assert_exit(result, 3, "patch-match.cfg")
        self.assertLess(max(map(len, result.stderr.splitlines())), 1000)

    def test_what_colmap_reads_is_read_alike(self):
        for text in (
            "# comment\r\n\r\n view00.png \r\n# between\r\nview01.png; view02.png, ,\r\n",
            "view00.png\n__auto__, -1\n",
            "view00.png\n__all__\nview01.png\n",
        ):
            with self.subTest(text):
                self.assert_exit(self.run_with(text), 0)
                self.assertEqual(len(map_files(self.dense)), 4)
                self.assert_complete(self.dense, ["view00.png"])

    def test_nothing_to_do_is_exit_3_and_says_what_to_write(self):
        for text in ("", "view00.png\n__auto__, 0\n"):
            with self.subTest(text):
                self.assert_exit(self.run_with(text), 3, "patch-match.cfg", "; ")
                self.assertEqual(map_files(self.dense), {})

    def test_a_missing_configuration_is_exit_3(self):
        workspace = self.workspace()
        (workspace / "stereo/patch-match.cfg").unlink()
        self.assert_exit(self.run_tool(workspace, *FAST), 3, "patch-match.cfg")


if __name__ == "__main__":
    unittest.main()
