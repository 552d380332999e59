"""Images that are missing, damaged, huge, tiny or without any contrast; few of them, and a filter
that leaves none of their pixels."""
import json
import resource
import unittest

from png import bomb, constant, png
from support import FAST, IS_SANITIZED, CliTest, map_files, read_map


class BadImages(CliTest):
    def assert_one_image_fails(self, damage):
        """The image fails by name with exit 4, the others get maps, a repair completes."""
        workspace = self.workspace()
        path = workspace / "images/view02.png"
        good = path.read_bytes()
        damage(path)
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 4, "view02.png")
        self.assert_no_partial_files(workspace)
        self.assert_complete(workspace, ["view00.png", "view01.png", "view03.png"])
        path.write_bytes(good)
        self.assert_rerun_completes(workspace)

    def test_a_missing_image(self):
        self.assert_one_image_fails(lambda path: path.unlink())

    def test_an_empty_image(self):
        self.assert_one_image_fails(lambda path: path.write_bytes(b""))

    def test_an_image_that_is_no_image(self):
        self.assert_one_image_fails(lambda path: path.write_text("not a picture"))

    def test_an_image_cut_after_its_header(self):
        self.assert_one_image_fails(lambda path: path.write_bytes(path.read_bytes()[:60]))

    def test_half_an_image(self):
        self.assert_one_image_fails(
            lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        )

    @unittest.skipIf(IS_SANITIZED, "sanitizers need address space of their own")
    def test_a_bomb_is_refused_before_it_is_decoded(self):
        workspace = self.workspace()
        path = workspace / "images/view02.png"
        good = path.read_bytes()
        path.write_bytes(bomb(65500, 65500))
        limit = 4 << 30
        result = self.run_tool(
            workspace,
            *FAST,
            timeout=20,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        )
        self.assert_exit(result, 4, "view02.png")
        self.assert_no_partial_files(workspace)
        path.write_bytes(good)
        self.assert_rerun_completes(workspace)

    @unittest.skipIf(IS_SANITIZED, "sanitizers need address space of their own")
    def test_a_header_far_beyond_the_camera_costs_the_others_nothing(self):
        for width, height in ((20000, 20000), (20000, 15000), (32, 65500)):
            with self.subTest((width, height)):
                workspace = self.workspace()
                (workspace / "images/view02.png").write_bytes(bomb(width, height))
                limit = 1 << 30
                result = self.run_tool(
                    workspace,
                    *FAST,
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
                )
                self.assert_exit(result, 4, "view02.png")
                self.assertIn(f"view02.png is {width}x{height}", result.stderr)
                self.assert_complete(workspace, ["view00.png", "view01.png", "view03.png"])

    def test_a_picture_turned_after_the_reconstruction_fails_and_is_no_source(self):
        workspace = self.workspace()
        cfg = workspace / "stereo/patch-match.cfg"
        everything = cfg.read_text()
        upright = [f"view0{i}.png" for i in (0, 1, 3)]
        cfg.write_text("".join(f"{name}\n{', '.join(upright)}\n" for name in upright))
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        without = map_files(workspace)
        cfg.write_text(everything.replace("__auto__, 20", "__all__"))
        (workspace / "images/view02.png").write_bytes(constant(72, 96, 77))
        result = self.run_tool(workspace, *FAST, "--Hpm.overwrite=1")
        self.assert_exit(result, 4, "1 of 4 images failed", "view02.png")
        self.assertRegex(result.stderr, "view02.png is 72x96, its camera 96x72.*rotation.*EXIF")
        self.assert_same_maps(map_files(workspace), without)

    def test_a_broken_image_leaves_no_maps_between_stages_and_is_not_in_the_way(self):
        workspace = self.workspace(width=48, height=36)
        path = workspace / "images/view02.png"
        good = path.read_bytes()
        options = [o for o in FAST if "num_geom_passes" not in o] + ["--Hpm.num_geom_passes=3"]
        self.assert_exit(self.run_tool(workspace, *options), 0)
        expected = map_files(workspace)
        for damaged in (good[:60], b"not a picture"):
            path.write_bytes(damaged)
            for computed, kept in ((3, 0), (0, 3)):
                result = self.run_tool(workspace, *options)
                self.assert_exit(result, 4, "1 of 4 images failed", "view02.png")
                self.assertIn(f"{computed} computed, {kept} kept", result.stdout)
                state = workspace / "stereo/hpm_mvs"
                folders = {p.name for p in state.iterdir() if p.is_dir()}
                self.assertLessEqual(folders, {"stamps", "unreadable_images"})
            path.write_bytes(good)
            self.assert_exit(self.run_tool(workspace, *options), 0)
            self.assert_same_maps(map_files(workspace), expected)

    def test_all_commands_know_what_the_run_found_damaged(self):
        workspace = self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        path = workspace / "images/view02.png"
        good = path.read_bytes()
        path.write_bytes(good[:-40])
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 4, "1 of 4 images failed", "view02.png")
        self.assertRegex(result.stderr, "maps of an earlier run.*view02.png")
        self.assertNotIn("no report", result.stdout + result.stderr)
        self.assertIn("maps of an earlier run: no picture", (workspace / "stereo/report.html").read_text())
        status = self.run_command("status", workspace, *FAST)
        self.assert_exit(status, 4)
        self.assertIn("nothing to do until these images are mended", status.stdout)
        check = self.run_command("check", workspace, *FAST)
        self.assert_exit(check, 4)
        self.assertIn("view02.png geometric: what is there is of an earlier run, and fusion would use it", check.stdout)
        plan = self.run_command("plan", workspace, *FAST)
        self.assert_exit(plan, 4, "1 of 4 images would fail, the first: view02.png")
        self.assertIn("Images: 0 to compute, 3 kept", plan.stdout)
        self.assert_exit(self.run_command("report", workspace, *FAST), 0)
        self.assertIn("maps of an earlier run: no picture", (workspace / "stereo/report.html").read_text())
        path.write_bytes(good)
        self.assert_exit(self.run_command("status", workspace, *FAST), 8)
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        self.assert_exit(self.run_command("status", workspace, *FAST), 0)
        self.assertFalse((workspace / "stereo/hpm_mvs/unreadable_images").exists())

    def test_a_source_without_file_is_left_out_and_no_failure(self):
        """Only references count as failed: all maps that were asked for exist."""
        for options in ([], ["--PatchMatchStereo.allow_missing_files=1"]):
            for sources in ("__auto__, 20", "__all__"):
                with self.subTest(options=options, sources=sources):
                    workspace = self.workspace()
                    (workspace / "images/view02.png").unlink()
                    (workspace / "stereo/patch-match.cfg").write_text(
                        "".join(f"view0{i}.png\n{sources}\n" for i in (0, 1, 3))
                    )
                    result = self.run_tool(workspace, *FAST, *options)
                    self.assert_exit(result, 0)
                    self.assertIn("view02.png", result.stderr)
                    self.assertIn("3 computed, 0 kept from an earlier run, 0 failed", result.stdout)
                    self.assert_complete(workspace, ["view00.png", "view01.png", "view03.png"])

    def test_sixteen_bits_and_another_size_are_read(self):
        workspace = self.workspace()
        (workspace / "images/view00.png").write_bytes(png(96, 72, bytes(96 * 72 * 2), bits=16))
        (workspace / "images/view01.png").write_bytes(constant(48, 36, 77))
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        self.assert_no_partial_files(workspace)
        width, height, _, _ = read_map(workspace / "stereo/depth_maps/view01.png.geometric.bin")
        self.assertEqual((width, height), (48, 36))

    def test_images_without_contrast_give_finite_maps(self):
        for grey in (0, 128, 255):
            with self.subTest(grey=grey):
                workspace = self.workspace()
                for path in (workspace / "images").iterdir():
                    path.write_bytes(constant(96, 72, grey))
                self.assert_exit(self.run_tool(workspace, *FAST), 0)
                self.assert_complete(workspace)

    def test_images_smaller_than_the_window_give_finite_maps(self):
        for width, height in ((8, 6), (33, 1), (1, 33), (1, 1)):
            with self.subTest(size=(width, height)):
                workspace = self.workspace(width=width, height=height)
                (workspace / "stereo/patch-match.cfg").write_text(
                    "".join(f"view0{i}.png\n__all__\n" for i in range(4))
                )
                self.assert_rerun_completes(
                    workspace,
                    *FAST,
                    "--PatchMatchStereo.depth_min=3",
                    "--PatchMatchStereo.depth_max=8",
                )


class FewImages(CliTest):
    def test_a_single_image_is_exit_3_and_says_why(self):
        workspace = self.workspace(views=1)
        for sources in ("__auto__, 20", "__all__"):
            (workspace / "stereo/patch-match.cfg").write_text(f"view00.png\n{sources}\n")
            result = self.run_tool(
                workspace,
                *FAST,
                "--PatchMatchStereo.depth_min=1",
                "--PatchMatchStereo.depth_max=10",
            )
            self.assert_exit(result, 3, "patch-match.cfg", "source images")
            self.assertIn("view00.png, because it has no source images", result.stderr)
            self.assertEqual(map_files(workspace), {})

    def test_one_source_is_enough(self):
        workspace = self.workspace(views=2)
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        self.assert_complete(workspace)
        values = read_map(workspace / "stereo/depth_maps/view00.png.geometric.bin")[3]
        self.assertGreater(sum(v > 0 for v in values), len(values) / 4)

    def test_the_option_that_fusion_of_few_images_needs_is_told(self):
        for views, option in ((2, "--StereoFusion.min_num_pixels 2\n"), (6, None)):
            with self.subTest(views):
                result = self.run_tool(self.workspace(views=views, width=48, height=36), *FAST)
                self.assert_exit(result, 0)
                if option:
                    self.assertIn(option, result.stdout)
                else:
                    self.assertNotIn("min_num_pixels", result.stdout)

    def test_a_few_references_bring_their_sources_along(self):
        workspace = self.workspace()
        (workspace / "stereo/patch-match.cfg").write_text("view01.png\n__auto__, 20\n")
        result = self.run_tool(workspace, *FAST)
        self.assert_exit(result, 0)
        self.assertIn("Configuration has 1 problems...", result.stdout)
        self.assertIn("3 further images are estimated", result.stdout)
        self.assertIn("1 images: 1 computed", result.stdout)
        self.assert_complete(workspace, ["view01.png"])
        self.assertTrue(all("view01" in name for name in map_files(workspace)))
        record = json.loads((workspace / "stereo/hpm_mvs/run.json").read_text())
        self.assertEqual((record["images_computed"], record["sources_computed"]), (1, 3))


class Filter(CliTest):
    def test_a_filter_that_takes_everything_names_its_option_once(self):
        for option, criterion in (
            ("filter_min_triangulation_angle=80", "angle"),
            ("filter_min_ncc=1", "correlation"),
            ("filter_geom_consistency_max_cost=0", "geometry"),
            ("filter_min_num_consistent=3", None),
        ):
            with self.subTest(option):
                workspace = self.workspace(width=64, height=48)
                result = self.run_tool(workspace, *FAST, f"--PatchMatchStereo.{option}")
                self.assert_exit(result, 0)
                record = json.loads((workspace / "stereo/hpm_mvs/run.json").read_text())
                if criterion is None:
                    self.assertNotIn("--PatchMatchStereo.filter", result.stderr)
                    continue
                self.assertEqual(result.stderr.count(option.split("=")[0]), 1, result.stderr)
                self.assertIn("4 of 4 images", result.stderr)
                self.assertIn("Pixels dropped by: ", result.stdout)
                self.assertGreater(record["filter_losses"][criterion], 0.8)
                for image in record["images"].values():
                    self.assertGreater(image["geometric"]["filter_losses"][criterion], 0.8)


if __name__ == "__main__":
    unittest.main()
