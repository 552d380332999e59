"""Runs shared among processes: --Hpm.shard and --Hpm.stage. The maps are those of one
run, for every division, order and repetition."""
import json
import os
import random
import re
import shutil
import subprocess
import unittest

from support import FAST, HPM_MVS, CliTest, map_files

NOT_READY = 8
# A stage whose maps are published, one whose maps only the next needs, and the last.
OPTIONS = [option.replace("geom_passes=1", "geom_passes=2") for option in FAST]


class Shards(CliTest):
    def setUp(self):
        self.dense = self.workspace(views=7, width=64, height=48)

    def expected(self):
        """The maps of one run, on a copy."""
        whole = self.dense.parent / "whole"
        shutil.copytree(self.dense, whole)
        self.assert_exit(self.run_tool(whole, *OPTIONS), 0)
        return map_files(whole)

    def status(self):
        result = subprocess.run(
            [HPM_MVS, "status", "--workspace_path", str(self.dense), *OPTIONS, "--format", "json"],
            stdout=subprocess.PIPE,
            text=True,
            timeout=120,
        )
        return result.returncode, json.loads(result.stdout)

    def stages(self):
        return [stage["name"] for stage in self.status()[1]["stages"]]

    def run_share(self, shard, stage, code=0, *options):
        result = self.run_tool(
            self.dense, *OPTIONS, f"--Hpm.shard={shard}", f"--Hpm.stage={stage}", *options
        )
        self.assert_exit(result, code)
        return result

    def inner_maps(self):
        state = self.dense / "stereo/hpm_mvs"
        return [p for p in state.rglob("*.bin")]

    def test_every_division_gives_the_bytes_of_one_run(self):
        expected = self.expected()
        shuffled = random.Random(1)
        for count in (1, 3, 7):
            for stage in self.stages():
                shards = list(range(count))
                shuffled.shuffle(shards)
                for index in [*shards, shards[0]]:  # one once more
                    self.run_share(f"{index}/{count}", stage)
            self.assertTrue(self.inner_maps())
            self.assertEqual(self.status()[0], 0)
            self.run_share("0/1", "finish")
            self.assertEqual(self.inner_maps(), [])
            self.assert_same_maps(map_files(self.dense), expected)
            self.assert_no_partial_files(self.dense)
            shutil.rmtree(self.dense / "stereo/hpm_mvs")
            for kind in ("depth_maps", "normal_maps"):
                shutil.rmtree(self.dense / "stereo" / kind)

    def test_shards_work_side_by_side_and_a_whole_run_goes_on_from_them(self):
        expected = self.expected()
        for stage in self.stages()[:-1]:
            processes = [
                subprocess.Popen(
                    self.command(
                        self.dense, *OPTIONS, f"--Hpm.shard={i}/3", f"--Hpm.stage={stage}"
                    ),
                    stdout=subprocess.DEVNULL,
                )
                for i in range(3)
            ]
            self.assertEqual([process.wait(timeout=120) for process in processes], [0, 0, 0])
        self.assert_exit(self.run_tool(self.dense, *OPTIONS), 0)
        self.assert_same_maps(map_files(self.dense), expected)

    def test_what_is_not_there_yet_is_exit_8_with_its_name(self):
        stages = self.stages()
        self.run_share("0/2", stages[0])
        result = self.run_share("0/2", stages[1], NOT_READY)
        self.assertIn(stages[0], result.stderr)
        self.assertIn(".png", result.stderr)
        result = self.run_share("0/2", "all", NOT_READY)
        self.run_share("0/1", "finish", NOT_READY)
        self.run_share("1/2", stages[0])
        self.run_share("0/2", stages[1])
        self.assertEqual(self.status()[0], NOT_READY)

    def test_a_map_that_was_damaged_meanwhile_is_not_read(self):
        stages = self.stages()
        for i in range(2):
            self.run_share(f"{i}/2", stages[0])
        damaged = self.dense / "stereo/depth_maps/view06.png.photometric.bin"
        damaged.write_bytes(damaged.read_bytes()[:-4])
        self.run_share("1/2", stages[1], NOT_READY)
        self.run_share("1/2", stages[0])
        self.run_share("1/2", stages[1])

    def test_a_damaged_image_is_known_to_all_once_one_has_found_it(self):
        image = self.dense / "images/view03.png"
        data = image.read_bytes()
        image.write_bytes(data[: len(data) // 2])
        whole = self.dense.parent / "whole"
        shutil.copytree(self.dense, whole)
        self.assert_exit(self.run_tool(whole, *OPTIONS), 4)
        for _ in range(2):  # the second time all know
            for stage in self.stages():
                for i in range(3):
                    self.run_tool(self.dense, *OPTIONS, f"--Hpm.shard={i}/3", f"--Hpm.stage={stage}")
        self.run_share("0/1", "finish", 4)
        self.assert_same_maps(map_files(self.dense), map_files(whole))

    def write_row(self, order):
        """A cfg in which the sources of an image are its neighbours in a row."""
        name = "view{:02}.png".format
        (self.dense / "stereo/patch-match.cfg").write_text("".join(
            f"{name(i)}\n{', '.join(name(j) for j in (i - 1, i + 1) if 0 <= j < 7)}\n"
            for i in order))

    def worked_on(self, shard, code=0):
        result = self.run_share(shard, self.stages()[0], code)
        return [int(n) for n in re.findall(r"Processing view \d+ / \d+ for view0(\d)", result.stdout)]

    def test_a_shard_is_a_part_of_the_order_of_overlap(self):
        self.write_row((2, 6, 3, 1, 0, 5, 4))
        self.assertEqual(self.worked_on("1/2"), [5, 6, 1, 0])
        self.assertEqual(self.worked_on("0/2"), [2, 3, 4])

    def test_damage_that_only_one_shard_knows_of_does_not_change_the_division(self):
        self.write_row((2, 6, 3, 1, 0, 5, 4))
        image = self.dense / "images/view03.png"
        data = image.read_bytes()
        image.write_bytes(data[: len(data) // 2])
        self.worked_on("1/2")  # needs it nowhere
        self.assertEqual(set(self.worked_on("0/2", 4)), {2, 3, 4})
        self.assertEqual(self.status()[1]["stages"][0]["needed"], 0)

    def test_a_whole_run_and_shards_exclude_each_other(self):
        slow = ["--Hpm.num_iterations=4000", "--PatchMatchStereo.num_threads=1"]
        stage = self.stages()[0]
        shard = self.start_tool(self.dense, *slow, "--Hpm.shard=0/2")
        self.assert_exit(self.run_tool(self.dense, *OPTIONS), 7, str(shard.pid))
        result = self.run_tool(self.dense, *OPTIONS, "--Hpm.shard=0/2")
        self.assert_exit(result, 7, str(shard.pid))
        result = self.run_tool(self.dense, *OPTIONS, "--Hpm.shard=0/3")
        self.assert_exit(result, 7, str(shard.pid))
        self.run_share("1/2", stage)
        shard.kill()
        shard.wait()
        whole = self.start_tool(self.dense, *slow)
        self.assert_exit(self.run_tool(self.dense, *OPTIONS, "--Hpm.shard=1/2"), 7, str(whole.pid))
        whole.kill()
        whole.wait()
        self.run_share("0/2", stage)

    def test_a_killed_shard_goes_on_where_it_stopped(self):
        expected = self.expected()
        stages = self.stages()
        process = self.start_tool(
            self.dense, *OPTIONS, "--Hpm.shard=0/2", f"--Hpm.stage={stages[0]}"
        )
        process.kill()
        process.wait()
        for stage in stages:
            for i in range(2):
                self.run_share(f"{i}/2", stage)
        self.run_share("0/1", "finish")
        self.assert_same_maps(map_files(self.dense), expected)
        self.assert_no_partial_files(self.dense)

    def test_the_report_comes_with_the_end(self):
        report = self.dense / "stereo/report.html"
        for stage in self.stages():
            self.run_share("0/1", stage, 0, "--Hpm.report=1")
            self.assertFalse(report.exists())
        report.write_text("of another day")
        self.run_share("0/1", "finish", 0, "--Hpm.report=1")
        self.assertIn("view00.png", report.read_text())

    def test_the_lock_names_the_job(self):
        environment = {**os.environ, "SLURM_JOB_ID": "4711", "SLURM_ARRAY_TASK_ID": "0"}
        log = open(self.dense / "log.txt", "wb")
        process = subprocess.Popen(
            self.command(self.dense, "--Hpm.num_iterations=4000", "--Hpm.shard=0/2"),
            stdout=log, stderr=subprocess.STDOUT, env=environment,
        )
        log.close()
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        while b"Processing view" not in (self.dense / "log.txt").read_bytes():
            self.assertIsNone(process.poll())
        self.assert_exit(self.run_tool(self.dense, *OPTIONS), 7, "4711_0")

    def plan(self, *options):
        return subprocess.run(
            [HPM_MVS, "plan", "--workspace_path", str(self.dense), *OPTIONS, *options],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120,
        )

    def test_plan_says_what_the_share_would_do_and_what_stops_it(self):
        first, second = self.stages()[:2]
        mine = self.plan(f"--Hpm.stage={first}", "--Hpm.shard=1/3")
        self.assertEqual(mine.returncode, 0, mine.stdout)
        self.assertIn("0 kept", mine.stdout)
        self.assertNotIn("could not be measured", mine.stdout)
        for code, options in (
            (2, ["--Hpm.stage=polishing"]),
            (NOT_READY, ["--Hpm.stage=finish"]),
            (NOT_READY, [f"--Hpm.stage={second}"]),
            (2, ["--Hpm.overwrite=1", "--Hpm.shard=0/3"]),
        ):
            result = self.plan(*options)
            self.assertEqual(result.returncode, code, f"{options}\n{result.stdout}")

    def test_a_damaged_inner_map_is_made_again_by_its_own_shard(self):
        stages = self.stages()
        for stage in stages[:-1]:
            for i in range(2):
                self.run_share(f"{i}/2", stage)
        inner = stages[-2]
        path = self.dense / f"stereo/hpm_mvs/{inner}/view00.png.depth.bin"
        good, times = path.read_bytes(), path.stat()
        # As after a power cut: the stamp holds, the bytes do not.
        for stamp in (self.dense / "stereo/hpm_mvs/stamps" / inner).rglob("*.json"):
            record = json.loads(stamp.read_text())
            record["unsynced_since"] = "another kernel"
            stamp.write_text(json.dumps(record))
        path.write_bytes(good[:-4] + b"\0\0\0\0")
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
        self.run_share("1/2", stages[-1], NOT_READY)
        self.run_share("0/2", inner)
        self.assertEqual(path.read_bytes(), good)
        self.run_share("1/2", stages[-1])

    def test_the_record_of_an_older_run_does_not_stay(self):
        self.assert_exit(self.run_tool(self.dense, *OPTIONS), 0)
        self.assertTrue((self.dense / "stereo/hpm_mvs/run.json").exists())
        for stage in self.stages():
            result = self.run_tool(
                self.dense, *OPTIONS, "--random_seed=5", "--Hpm.shard=0/1", f"--Hpm.stage={stage}"
            )
            self.assert_exit(result, 0)
        self.assertFalse((self.dense / "stereo/hpm_mvs/run.json").exists())

    def test_nonsense_is_exit_2(self):
        self.run_share("0/2", "finish", 2)
        self.run_share("3/3", "all", 2)
        result = self.run_share("0/1", "polishing", 2)
        self.assertIn("photometric", result.stderr)
        self.run_share("0/2", "all", 2, "--Hpm.overwrite=1")


if __name__ == "__main__":
    unittest.main()
