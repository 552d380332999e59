"""patch_match_stereo() of the Python package: the files of the program, its errors as
exceptions, callbacks, and a stop within two seconds."""
import logging
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import hpm_mvs
from support import FAST, SLOW, CliTest, map_files


def as_dict(options):
    return dict(option[2:].split("=") for option in options)


class Workspace(CliTest):
    def test_gives_the_bytes_of_the_program(self):
        workspace, other = self.workspace(), self.workspace()
        self.assert_exit(self.run_tool(workspace, *FAST), 0)
        summary = hpm_mvs.patch_match_stereo(other, options=as_dict(FAST))
        self.assert_complete(other)
        self.assert_same_maps(map_files(other), map_files(workspace))
        self.assertEqual((summary.num_problems, summary.num_computed, summary.num_kept), (4, 4, 0))
        self.assertEqual((summary.failed, summary.num_fusable), ([], 4))
        self.assertGreater(summary.valid_pixel_share, 0.5)
        self.assertIsInstance(summary.filter_losses, dict)
        self.assertTrue((other / "stereo/report.html").exists())

    def test_an_equal_call_keeps_the_maps(self):
        workspace = self.workspace()
        hpm_mvs.patch_match_stereo(workspace, **as_dict(FAST))
        again = hpm_mvs.patch_match_stereo(str(workspace), "COLMAP", **as_dict(FAST))
        self.assertEqual((again.num_computed, again.num_kept), (0, 4))
        # The program takes them for its own, too.
        self.assertIn("4 kept", self.run_tool(workspace, *FAST).stdout)

    def test_the_config_is_read(self):
        workspace = self.workspace()
        config = workspace / "one.cfg"
        config.write_text("view00.png\nview01.png, view02.png\n")
        summary = hpm_mvs.patch_match_stereo(workspace, config_path=config, **as_dict(FAST))
        self.assertEqual(summary.num_problems, 1)

    def test_messages_go_to_the_logger(self):
        workspace = self.workspace()
        with self.assertLogs("hpm_mvs", logging.INFO) as logs:
            hpm_mvs.patch_match_stereo(workspace, ncc_sigma=0.3, **as_dict(FAST))
        lines = [(record.levelname, record.getMessage()) for record in logs.records]
        self.assertEqual(lines[0][0], "INFO")
        self.assertIn(hpm_mvs.__version__, lines[0][1])
        self.assertTrue(any(l == "WARNING" and "ncc_sigma has no effect" in m for l, m in lines))
        self.assertTrue(any("Processing view 1 / 4" in message for _, message in lines))


class Errors(CliTest):
    def check(self, kind, code, words, workspace, **options):
        with self.assertRaises(kind) as caught:
            hpm_mvs.patch_match_stereo(workspace, **{**as_dict(FAST), **options})
        self.assertIsInstance(caught.exception, hpm_mvs.Error)
        self.assertIsInstance(caught.exception, RuntimeError)
        self.assertEqual(caught.exception.exit_code, code)
        for word in words:
            self.assertIn(str(word), str(caught.exception))
        return caught.exception

    def test_exit_codes_are_those_of_the_program(self):
        codes = {kind.__name__: kind.exit_code for kind in hpm_mvs.Error.__subclasses__()}
        self.assertEqual(
            codes,
            {"Failure": 1, "UsageError": 2, "InputError": 3, "PartialError": 4,
             "ResourcesError": 5, "DeviceError": 6, "LockedError": 7, "NotReadyError": 8, "InterruptedRunError": 130},
        )

    def test_a_wrong_option(self):
        workspace = self.workspace()
        error = self.check(hpm_mvs.UsageError, 2, ["depth_min"], workspace, depth_min=5, depth_max=2)
        self.assertIsInstance(error, ValueError)
        self.check(hpm_mvs.UsageError, 2, ["workspace_format", "PMVS"], workspace,
                   workspace_format="X")
        self.check(hpm_mvs.UsageError, 2, ["progress"], workspace, progress=3)

    def test_a_workspace_that_is_not_there(self):
        self.check(hpm_mvs.InputError, 3, ["/nowhere"], "/nowhere")

    def test_a_damaged_image(self):
        workspace = self.workspace()
        (workspace / "images/view02.png").write_text("not a picture")
        error = self.check(hpm_mvs.PartialError, 4, ["view02.png"], workspace)
        self.assertEqual(error.summary.failed, ["view02.png"])
        self.assertEqual(error.summary.num_fusable, 3)

    def test_a_card_that_is_not_there(self):
        options = {"Hpm.device": "cuda", "gpu_index": "99"}
        self.check(hpm_mvs.DeviceError, 6, ["GPU"], self.workspace(), **options)

    def test_maps_of_other_shards_that_are_not_there_yet(self):
        options = {"Hpm.stage": "finish"}
        self.check(hpm_mvs.NotReadyError, 8, ["status"], self.workspace(), **options)

    def test_a_workspace_in_use(self):
        workspace = self.workspace()
        process = self.start_tool(workspace, *SLOW)
        self.check(hpm_mvs.LockedError, 7, [process.pid], workspace)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=10), 130)


class Progress(CliTest):
    def test_is_told_in_the_thread_of_the_caller(self):
        events, threads = [], set()

        def progress(event):
            events.append(event)
            threads.add(threading.get_ident())

        hpm_mvs.patch_match_stereo(self.workspace(), progress=progress, **as_dict(FAST))
        self.assertEqual(threads, {threading.get_ident()})
        fractions = [event.fraction for event in events]
        self.assertEqual(fractions, sorted(fractions))
        self.assertAlmostEqual(fractions[-1], 1)
        self.assertIn("photometric", {event.stage for event in events})
        self.assertIn("view03.png", {event.image for event in events})
        self.assertTrue(all(e.title and 0 <= e.image_number <= e.num_images == 4 for e in events),
                        events)

    def test_what_it_raises_stops_the_run_and_is_raised(self):
        workspace = self.workspace()
        calls = []

        def progress(event):
            calls.append(time.monotonic())
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            hpm_mvs.patch_match_stereo(workspace, progress=progress, **as_dict(SLOW))
        self.assertLess(time.monotonic() - calls[0], 2)
        self.assertEqual(len(calls), 1)
        self.assert_no_partial_files(workspace)
        self.assert_rerun_completes(workspace)

    def test_a_second_run_in_the_process_is_refused(self):
        workspace, other = self.workspace(), self.workspace()
        refused = []

        def progress(event):
            with self.assertRaisesRegex(hpm_mvs.UsageError, "in this process") as caught:
                hpm_mvs.patch_match_stereo(other, **as_dict(FAST))
            refused.append(caught.exception)

        hpm_mvs.patch_match_stereo(workspace, progress=progress, **as_dict(FAST))
        self.assertGreater(len(refused), 0)
        hpm_mvs.patch_match_stereo(other, **as_dict(FAST))

    def test_other_threads_of_python_go_on(self):
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.wait(0.01):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        hpm_mvs.patch_match_stereo(self.workspace(), **{**as_dict(FAST), "num_threads": 1})
        end = time.monotonic()
        stop.set()
        thread.join()
        times = [begin, *(t for t in ticks if begin <= t <= end), end]
        self.assertLess(max(b - a for a, b in zip(times, times[1:])), (end - begin) / 2)


class Interruption(CliTest):
    def test_ctrl_c_is_keyboard_interrupt_within_two_seconds(self):
        workspace = self.workspace()
        sent = []

        def progress(event):
            if not sent:
                sent.append(time.monotonic())
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            hpm_mvs.patch_match_stereo(workspace, progress=progress, **as_dict(SLOW))
        self.assertLess(time.monotonic() - sent[0], 2)
        self.assert_no_partial_files(workspace)

    def test_an_interrupted_run_goes_on(self):
        workspace, straight = self.workspace(), self.workspace()
        options = {**as_dict(FAST), "Hpm.num_iterations": 3}

        def progress(event):
            if event.stage != "photometric":
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            hpm_mvs.patch_match_stereo(workspace, progress=progress, **options)
        again = []
        hpm_mvs.patch_match_stereo(workspace, progress=again.append, **options)
        hpm_mvs.patch_match_stereo(straight, **options)
        self.assert_same_maps(map_files(workspace), map_files(straight))
        self.assertNotIn("photometric", {event.stage for event in again if event.image})

    def test_a_script_that_gets_sigint(self):
        workspace = self.workspace()
        script = (
            "import sys, hpm_mvs\n"
            "def progress(event): print(event.fraction, flush=True)\n"
            f"hpm_mvs.patch_match_stereo(sys.argv[1], progress=progress, **{as_dict(SLOW)})\n"
        )
        process = subprocess.Popen(
            [sys.executable, "-c", script, workspace], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True,
        )
        self.addCleanup(process.kill)
        process.stdout.readline()
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30)
        self.assertLess(time.monotonic() - begin, 2.5)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertEqual(process.returncode, -signal.SIGINT)
        self.assert_rerun_completes(workspace)


if __name__ == "__main__":
    unittest.main()
