"""The command line: help, wrong options, locale."""
import os
import subprocess
import unittest

from support import FAST, HPM_MVS, CliTest, map_files


def run(*arguments, **keywords):
    return subprocess.run(
        [HPM_MVS, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        timeout=60,
        **keywords,
    )


class Help(CliTest):
    def test_help_is_on_standard_output_with_exit_0(self):
        for arguments in (["help"], ["patch_match_stereo", "--help"], ["patch_match_stereo", "-h"]):
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertIn("--PatchMatchStereo.max_image_size", result.stdout)

    def test_help_that_cannot_be_written_is_not_exit_0(self):
        for arguments in (["help"], ["version"], ["patch_match_stereo", "--help"]):
            with open("/dev/full", "wb") as full:
                result = subprocess.run(
                    [HPM_MVS, *arguments], stdout=full, stderr=subprocess.PIPE, timeout=60
                )
            self.assertEqual(result.returncode, 1)
            self.assertIn(b"standard output", result.stderr)

    def test_a_reader_that_has_seen_enough_is_no_error(self):
        for arguments in (["help"], ["version"], ["patch_match_stereo", "--help"]):
            reader, writer = os.pipe()
            os.close(reader)  # as `| head -1` and `| grep -q` do
            result = subprocess.run(
                [HPM_MVS, *arguments], stdout=writer, stderr=subprocess.PIPE, timeout=60
            )
            os.close(writer)
            self.assertEqual((result.returncode, result.stderr), (0, b""))

    def test_help_wins_over_other_options(self):
        self.assertEqual(run("patch_match_stereo", "--workspace_path", "x", "--help").returncode, 0)


class WrongOptions(CliTest):
    def assert_usage_error(self, workspace, *options):
        result = self.run_tool(workspace, *options)
        self.assert_exit(result, 2, options[0].lstrip("-").split("=")[0])
        self.assertEqual(map_files(workspace), {})

    def test_each_is_exit_2_and_names_the_option(self):
        workspace = self.workspace()
        for options in (
            ["--PatchMatchStereo.window_radius=-1"],
            ["--PatchMatchStereo.window_radius=33"],
            ["--PatchMatchStereo.window_radius=3.5"],
            ["--PatchMatchStereo.window_step=3"],
            ["--PatchMatchStereo.sigma_color=nan"],
            ["--PatchMatchStereo.sigma_color=0"],
            ["--PatchMatchStereo.num_samples=999999999999"],
            ["--PatchMatchStereo.num_iterations=0"],
            ["--PatchMatchStereo.cache_size=-1"],
            ["--PatchMatchStereo.cache_size=1e999"],
            ["--PatchMatchStereo.gpu_index=x"],
            ["--PatchMatchStereo.filter=2"],
            ["--PatchMatchStereo.filter_min_ncc=1,5"],
            ["--PatchMatchStereo.min_triangulation_angle=180"],
            ["--PatchMatchStereo.depth_min=2", "--PatchMatchStereo.depth_max=1"],
            ["--PatchMatchStereo.depth_max=10"],
            ["--Hpm.method=magic"],
            ["--Hpm.cpu_target=abacus"],
            ["--Hpm.num_iterations=-2"],
            ["--Hpm.num_iterations=2147483647"],
            ["--Hpm.num_geom_passes=2147483647"],
            ["--PatchMatchStereo.num_threads=2147483647"],
            ["--workspace_format=OTHER"],
            ["--unknown=1"],
        ):
            with self.subTest(options):
                self.assert_usage_error(workspace, *options)

    def test_slips_of_the_hand_are_understood(self):
        for arguments, right in (
            (["patch_match_stereo", "--Hpm.qualty=low"], "--Hpm.quality"),
            (["patch_match_stereo", "--workspace-path=x"], "--workspace_path"),
            (["chek"], "check"),
        ):
            self.assert_exit(run(*arguments), 2, f"did you mean {right}?")

    def test_a_word_that_is_no_option_is_ignored_as_by_colmap_and_named(self):
        result = run("patch_match_stereo", "stray", "--workspace_path", "/nowhere")
        self.assert_exit(result, 3)
        self.assertIn("'stray' is ignored", result.stdout + result.stderr)

    def test_long_values_are_refused_and_echoed_in_short(self):
        long = 100_000 * "a"
        for option in (
            f"--workspace_path={long}",
            f"--PatchMatchStereo.num_threads={long}",
            f"--Hpm.method={long}",
            f"--{long}=1",
        ):
            result = run("patch_match_stereo", option)
            self.assert_exit(result, 2, option[:12], "aaa... (100")
            self.assertLess(len(result.stderr), 1000)
        self.assertLess(len(run(long).stderr), 1000)

    def test_a_project_file_without_end_or_writer_is_exit_2(self):
        fifo = self.workspace() / "fifo"
        os.mkfifo(fifo)
        for path in (fifo, "/dev/zero"):
            result = run("patch_match_stereo", f"--project_path={path}")
            self.assert_exit(result, 2, path, "not a regular file")
        large = fifo.with_name("large.ini")
        large.write_bytes(bytes((1 << 20) + 1))
        self.assert_exit(run("patch_match_stereo", f"--project_path={large}"), 2, large, "1048576")

    def test_a_missing_workspace_option_is_exit_2(self):
        result = run("patch_match_stereo")
        self.assert_exit(result, 2, "workspace_path")

    def test_a_missing_workspace_is_exit_3_and_named(self):
        result = run("patch_match_stereo", "--workspace_path", "/nowhere/at/all")
        self.assert_exit(result, 3, "/nowhere/at/all")

    def test_an_unknown_command_is_exit_2(self):
        self.assert_exit(run("stereo_fusion"), 2, "stereo_fusion")


class Device(CliTest):
    """No GPU is visible, whatever the machine has."""

    HIDDEN = {**os.environ, "CUDA_VISIBLE_DEVICES": ""}

    def test_cuda_without_a_gpu_is_exit_6_and_names_the_remedy(self):
        workspace = self.workspace()
        result = self.run_tool(workspace, *FAST, "--Hpm.device", "cuda", env=self.HIDDEN)
        self.assert_exit(result, 6, "--Hpm.device cpu")
        self.assertEqual(map_files(workspace), {})

    def test_auto_without_a_gpu_says_so_and_gives_the_maps_of_the_cpu(self):
        auto, cpu = self.workspace(), self.workspace()
        result = self.run_tool(auto, *FAST, env=self.HIDDEN)
        self.assert_exit(result, 0)
        self.assertEqual(result.stdout.count("No GPU is used"), 1)
        self.assert_exit(self.run_tool(cpu, *FAST, "--Hpm.device", "cpu"), 0)
        self.assert_same_maps(map_files(auto), map_files(cpu))


class Locale(CliTest):
    def test_a_decimal_comma_changes_nothing(self):
        installed = subprocess.run(["locale", "-a"], stdout=subprocess.PIPE, text=True).stdout
        names = [n for n in installed.split() if n.lower().replace("-", "") == "de_de.utf8"]
        if not names:
            self.skipTest("the locale de_DE.UTF-8 is not installed")
        options = [*FAST, "--PatchMatchStereo.filter_min_ncc=0.25"]
        plain, german = self.workspace(), self.workspace()
        self.assert_exit(self.run_tool(plain, *options), 0)
        result = self.run_tool(german, *options, env={**os.environ, "LC_ALL": names[0]})
        self.assert_exit(result, 0)
        self.assert_same_maps(map_files(german), map_files(plain))


if __name__ == "__main__":
    unittest.main()
