"""A resumed run keeps only what is right: whatever happened to images and maps since, the
next run leaves the bytes of a run on a fresh workspace. HPM_RESUME_ROUNDS: more random
histories, HPM_RESUME_SEED: others."""
import os
import pathlib
import random
import shutil
import struct
import time
import unittest
import zlib

from support import FAST, TIME_FACTOR, CliTest, map_files

NUM_IMAGES = 4
NAMES = [f"view{i:02}.png" for i in range(NUM_IMAGES)]
OPTIONS = [
    *(o for o in FAST if "num_geom_passes" not in o),
    "--Hpm.num_geom_passes=2",
    "--PatchMatchStereo.write_consistency_graph=1",
]
CHANGED = "maps are damaged or were changed by others"


def padded(picture, num_bytes):
    """The same PNG picture in a file of so many bytes: by a chunk that nobody knows."""
    end = picture.rindex(b"IEND") - 4
    body = b"paDd" + bytes(num_bytes - len(picture) - 12)
    chunk = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    return picture[:end] + chunk + picture[end:]


def write_in_place(path, data):
    """Another time at any rate: clocks of file systems may be coarse."""
    time_ns = path.stat().st_mtime_ns
    path.write_bytes(data)
    if path.stat().st_mtime_ns == time_ns:
        os.utime(path, ns=(time_ns + 1, time_ns + 1))


def flip(data, place):
    return data[:place] + bytes([data[place] ^ 0x10]) + data[place + 1 :]


class ResumeTest(CliTest):
    def scene(self):
        """A workspace whose images all have the same length, and for each image its
        picture, another one, and two that cannot be read."""
        workspace = self.workspace(views=NUM_IMAGES, width=48, height=36)
        pictures = [(workspace / "images" / name).read_bytes() for name in NAMES]
        length = max(map(len, pictures)) + 100
        pictures = [padded(picture, length) for picture in pictures]
        versions = {}
        for i, name in enumerate(NAMES):
            good = pictures[i]
            versions[name] = {
                "good": good,
                "other": pictures[i - 1],
                "no picture": bytes(length),
                "no end": good[:60] + bytes(length - 60),
            }
            (workspace / "images" / name).write_bytes(good)
        return workspace, versions

    def run_whole(self, workspace, code=0):
        result = self.run_tool(workspace, *OPTIONS)
        self.assert_exit(result, code)
        self.assert_no_partial_files(workspace)
        return result


class Images(ResumeTest):
    def test_an_image_that_became_another_of_the_same_length_and_time_is_noticed(self):
        workspace, versions = self.scene()
        self.run_whole(workspace)
        first = map_files(workspace)
        path = workspace / "images" / NAMES[1]
        before = path.stat()
        path.write_bytes(versions[NAMES[1]]["other"])
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
        self.assertEqual(path.stat().st_size, before.st_size)

        fresh, _ = self.scene()
        (fresh / "images" / NAMES[1]).write_bytes(path.read_bytes())
        self.run_whole(fresh)
        self.assertIn("from other images", self.run_whole(workspace).stderr)
        self.assert_same_maps(map_files(workspace), map_files(fresh))
        path.write_bytes(versions[NAMES[1]]["good"])
        self.run_whole(workspace)
        self.assert_same_maps(map_files(workspace), first)

    def test_an_image_that_cannot_be_read_and_is_repaired_to_the_same_length(self):
        straight, versions = self.scene()
        self.run_whole(straight)
        for broken in ("no picture", "no end"):
            with self.subTest(broken):
                workspace, _ = self.scene()
                path = workspace / "images" / NAMES[2]
                path.write_bytes(versions[NAMES[2]][broken])
                self.run_whole(workspace, code=4)
                path.write_bytes(versions[NAMES[2]]["good"])
                self.run_whole(workspace)
                self.assert_same_maps(map_files(workspace), map_files(straight))

    def test_a_source_that_can_never_have_maps_is_not_waited_for(self):
        workspace, versions = self.scene()
        broken, others = NAMES[2], [name for name in NAMES if name != NAMES[2]]
        (workspace / "images" / broken).write_bytes(versions[broken]["no picture"])
        # The second image has no other source, so that it gets no maps either.
        lines = [f"{others[0]}\n{', '.join(others[1:])}\n", f"{others[1]}\n{broken}\n",
                 f"{others[2]}\n{others[0]}, {others[1]}\n"]
        (workspace / "stereo/patch-match.cfg").write_text("".join(lines))
        self.run_whole(workspace, code=4)
        self.assertIn("0 computed, 2 kept", self.run_whole(workspace, code=4).stdout)

    def test_an_image_that_changes_during_the_run_is_told_and_made_good(self):
        straight, versions = self.scene()
        slow = [o for o in OPTIONS if "num_iterations" not in o] + ["--Hpm.num_iterations=100"]
        self.assert_exit(self.run_tool(straight, *slow), 0)
        workspace, _ = self.scene()
        path = workspace / "images" / NAMES[0]
        # Never half written, which would be another fault.
        (workspace / "other").write_bytes(versions[NAMES[0]]["other"])
        process = self.start_tool(workspace, *slow)
        os.replace(workspace / "other", path)
        self.assertEqual(process.wait(60 * TIME_FACTOR), 0)
        log = (workspace / "log.txt").read_text()
        self.assertIn("1 of 4 images changed during this run", log)
        self.assertIn(str(path), log)
        write_in_place(path, versions[NAMES[0]]["good"])
        self.assert_exit(self.run_tool(workspace, *slow), 0)
        self.assert_same_maps(map_files(workspace), map_files(straight))


class Maps(ResumeTest):
    def finished(self):
        workspace, _ = self.scene()
        self.run_whole(workspace)
        return workspace, map_files(workspace)

    def assert_nothing_is_computed(self, workspace):
        result = self.run_whole(workspace)
        self.assertNotIn("Processing view", result.stdout)
        self.assertEqual(result.stderr, "")

    def test_a_map_that_was_changed_is_told_and_made_anew(self):
        workspace, good = self.finished()
        value = struct.pack("<f", float("nan")), struct.pack("<f", -1.0)
        faults = [
            lambda data: data[:-400] + value[0] + data[-396:],
            lambda data: data[:-400] + value[1] + data[-396:],
            lambda data: flip(data, len(data) // 2),
            lambda data: flip(data, 0),
            lambda data: bytes(len(data)),
            lambda data: data[:8] + data[8 + 192 : 8 + 384] + data[8 : 8 + 192] + data[8 + 384 :],
        ]
        for fault in faults:
            for kind in ("depth_maps", "normal_maps", "consistency_graphs"):
                for stage in ("photometric", "geometric"):
                    name = f"{kind}/{NAMES[1]}.{stage}.bin"
                    data = fault(good[name])
                    if data == good[name] or len(data) != len(good[name]):
                        continue
                    with self.subTest(name=name, fault=faults.index(fault)):
                        write_in_place(workspace / "stereo" / name, data)
                        result = self.run_whole(workspace)
                        self.assertIn(f"1 {CHANGED}", result.stderr)
                        self.assertIn(name, result.stderr)
                        self.assert_same_maps(map_files(workspace), good)

    def test_a_changed_photometric_map_is_no_input_of_new_geometric_ones(self):
        workspace, good = self.finished()
        name = f"depth_maps/{NAMES[1]}.photometric.bin"
        middle = len(good[name]) // 2 & ~3
        data = good[name][:middle] + bytes(2000) + good[name][middle + 2000 :]
        write_in_place(workspace / "stereo" / name, data)
        (workspace / "stereo/depth_maps" / f"{NAMES[0]}.geometric.bin").unlink()
        self.run_whole(workspace)
        self.assert_same_maps(map_files(workspace), good)

    def test_a_copy_with_other_times_keeps_everything(self):
        workspace, good = self.finished()
        copy = workspace.parent / "copy"
        shutil.copytree(workspace, copy, copy_function=shutil.copyfile)
        for path in (copy / "stereo").rglob("*.bin"):
            os.utime(path, ns=(0, 1_000_000_001))
        self.assert_nothing_is_computed(copy)
        self.assert_same_maps(map_files(copy), good)
        # The new times are stamped, beside what else the stamps say.
        stamp = "stereo/hpm_mvs/stamps/geometric/" + NAMES[0] + ".json"
        self.assertIn("1000000001", (copy / stamp).read_text())
        self.assertIn("valid_pixel_share", (copy / stamp).read_text())
        shutil.move(copy, workspace.parent / "moved")
        self.assert_nothing_is_computed(workspace.parent / "moved")

    def test_maps_of_the_stamped_size_and_time_are_not_read(self):
        """So resuming is cheap; an edit that puts the time back is not noticed."""
        workspace, good = self.finished()
        name = f"depth_maps/{NAMES[1]}.geometric.bin"
        path = workspace / "stereo" / name
        before = path.stat()
        path.write_bytes(flip(good[name], 1000))
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
        self.assert_nothing_is_computed(workspace)
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + 1))
        self.assertIn(name, self.run_whole(workspace).stderr)
        self.assert_same_maps(map_files(workspace), good)

    def test_stamps_of_an_older_version_vouch_for_nothing_and_one_line_says_so(self):
        workspace, good = self.finished()
        for path in (workspace / "stereo/hpm_mvs/stamps").rglob("*.json"):
            path.write_text(path.read_text().replace('"version": 2', '"version": 1'))
        result = self.run_whole(workspace)
        self.assertIn("4 computed", result.stdout)
        self.assertEqual(result.stderr.count("by another version"), 1, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assert_same_maps(map_files(workspace), good)

    def test_a_few_references_of_which_the_maps_are_gone(self):
        """Whatever the run over them leaves, the next whole run leaves what is right."""
        workspace = self.workspace(views=8, width=48, height=36)
        self.run_whole(workspace)
        good = map_files(workspace)
        cfg = workspace / "few.cfg"
        for sources in ("__auto__, 20", "__auto__, 2", "__all__", "view00.png, view04.png"):
            with self.subTest(sources):
                for i in (3, 5, 6):
                    for path in (workspace / "stereo").rglob(f"view{i:02}.png.geometric.bin"):
                        path.unlink()
                cfg.write_text("".join(f"view{i:02}.png\n{sources}\n" for i in (3, 5, 6)))
                result = self.run_tool(workspace, *OPTIONS, "--config_path", str(cfg))
                self.assert_exit(result, 0)
                self.assertEqual(set(map_files(workspace)), set(good))
                self.run_whole(workspace)
                self.assert_same_maps(map_files(workspace), good)


class Histories(ResumeTest):
    def setUp(self):
        self.random = random.Random(int(os.environ.get("HPM_RESUME_SEED", 1)))
        self.dense, self.versions = self.scene()
        self.images = {name: "good" for name in NAMES}
        self.old_maps = []
        self.fresh = {}

    def expected(self):
        """Exit code and maps of a run on a fresh workspace with the present images."""
        key = tuple(self.images.values())
        if key not in self.fresh:
            workspace, _ = self.scene()
            for name, version in self.images.items():
                (workspace / "images" / name).write_bytes(self.versions[name][version])
            result = self.run_tool(workspace, *OPTIONS)
            self.fresh[key] = result.returncode, map_files(workspace)
            shutil.rmtree(workspace)
        return self.fresh[key]

    def some_maps(self):
        maps = sorted((self.dense / "stereo").rglob("*.bin"))
        return self.random.sample(maps, min(len(maps), self.random.randint(1, 6)))

    def delete_maps(self):
        for path in self.some_maps():
            path.unlink()

    def damage_maps(self):
        for path in self.some_maps():
            data = path.read_bytes()
            begin = self.random.randrange(len(data))
            end = begin + self.random.randint(1, 3000)
            noise = self.random.choice([b"\0", b"\xff", b"\x3f"]) * len(data[begin:end])
            write_in_place(path, data[:begin] + noise + data[end:])

    def swap_two_maps(self):
        maps = self.some_maps()
        if len(maps) < 2:
            return
        a, b = maps[0], maps[-1]
        # With their times, as a renaming does.
        spare = self.dense / "spare"
        os.replace(a, spare)
        os.replace(b, a)
        os.replace(spare, b)

    def copy_maps_away(self):
        self.old_maps = []
        for i, path in enumerate(self.some_maps()):
            kept = self.dense.parent / f"old_{i}"
            shutil.copy2(path, kept)
            self.old_maps.append((path, kept))

    def copy_maps_back(self):
        for path, kept in self.old_maps:
            if path.parent.is_dir():
                shutil.copy2(kept, path)

    def touch_maps(self):
        for path in self.some_maps():
            os.utime(path)

    def change_image(self, *versions):
        name = self.random.choice(NAMES)
        self.images[name] = self.random.choice(versions)
        path = self.dense / "images" / name
        before = path.stat()
        path.write_bytes(self.versions[name][self.images[name]])
        if self.random.random() < 0.5:
            os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))

    def replace_image(self):
        self.change_image("good", "other")

    def break_image(self):
        if sum(version.startswith("no") for version in self.images.values()) < 2:
            self.change_image("no picture", "no end")

    def repair_images(self):
        for name, version in self.images.items():
            if version.startswith("no"):
                self.images[name] = "good"
                (self.dense / "images" / name).write_bytes(self.versions[name]["good"])

    def run_subset(self):
        cfg = self.dense / "subset.cfg"
        lines = []
        for name in self.random.sample(NAMES, self.random.randint(1, NUM_IMAGES - 1)):
            others = ", ".join(other for other in NAMES if other != name)
            sources = self.random.choice(["__auto__, 20", "__auto__, 1", "__all__", others])
            lines.append(f"{name}\n{sources}\n")
        cfg.write_text("".join(lines))
        result = self.run_tool(self.dense, *OPTIONS, "--config_path", str(cfg))
        self.assertIn(result.returncode, (0, 3, 4), result.stderr)

    def run_and_kill(self):
        try:
            process = self.start_tool(self.dense, *OPTIONS)
        except AssertionError:
            return  # there was nothing to compute
        time.sleep(self.random.random() * 0.2)
        process.kill()
        process.wait()

    def test_after_any_history_a_whole_run_leaves_the_bytes_of_a_fresh_one(self):
        steps = [
            self.delete_maps, self.damage_maps, self.swap_two_maps, self.copy_maps_away,
            self.copy_maps_back, self.touch_maps, self.replace_image, self.replace_image,
            self.break_image, self.repair_images, self.run_subset, self.run_and_kill,
        ]
        self.run_whole(self.dense)
        for round_number in range(int(os.environ.get("HPM_RESUME_ROUNDS", 10))):
            history = []
            for _ in range(self.random.randint(1, 6)):
                step = self.random.choice(steps)
                step()
                history.append(step.__name__)
            code, maps = self.expected()
            result = self.run_tool(self.dense, *OPTIONS)
            place = f"round {round_number} after {history} with {self.images}"
            self.assertEqual(result.returncode, code, f"{place}: {result.stderr}")
            left = map_files(self.dense)
            # Older maps of an image that cannot be read now stay where they are.
            wrong = [name for name in maps if left.get(name) != maps[name]]
            self.assertEqual(wrong, [], place)
            broken = [name for name, version in self.images.items() if version.startswith("no")]
            for name in set(left) - set(maps):
                self.assertIn(pathlib.Path(name).name.split(".png")[0] + ".png", broken, place)


if __name__ == "__main__":
    unittest.main()
