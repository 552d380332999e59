"""bench/gpu_bench.sh builds from a list of its own; it must have all of the library."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Decoding, planning a run, and what stands in for something absent.
NOT_NEEDED = {
    "src/base/threads.cc",
    "src/engine/memory_plan.cc",
    "src/image/image_integrity.cc",
    "src/image/load_image.cc",
    "src/image/shrink_image.cc",
    "src/prior/triangulation_opencv.cc",
    "cuda/no_cuda.cc",
}


class GpuSourcesTest(unittest.TestCase):
    def test_the_list_has_all_of_the_library(self):
        listed = set(re.findall(r"^  (\S+\.cu?c?)$", (ROOT / "bench/gpu/sources.sh").read_text(), re.M))
        library = {
            path.relative_to(ROOT).as_posix()
            for folder in ("src", "cuda")
            for path in (ROOT / folder).rglob("*")
            if path.suffix in {".cc", ".cu"}
        }
        self.assertEqual(library - listed, NOT_NEEDED)
        for source in listed:
            self.assertTrue((ROOT / source).exists(), source)


if __name__ == "__main__":
    unittest.main()
