"""The tests that docs/reliability.md names exist."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class ReliabilityTest(unittest.TestCase):
    def test_named_tests_exist(self):
        sources = "\n".join(
            path.read_text(errors="replace") for path in (ROOT / "tests").rglob("*")
            if path.suffix in {".cc", ".py"} or path.name == "CMakeLists.txt"
        )
        rows = re.findall(r"^\| \d+ \|.*\|", (ROOT / "docs/reliability.md").read_text(), re.M)
        self.assertEqual(len(rows), 30)
        for row in rows:
            cell = row.split("|")[-2]
            names = re.findall(r"`(test_\w+|[A-Z]\w+|\w+_test)`", cell)
            self.assertTrue(names, row)
            for name in names:
                self.assertRegex(sources, rf"(def |, |NAME ){name}\b")
            for reader in re.findall(r"`([a-z_]+)`", cell.split("fuzzer")[1] if "fuzzer" in cell else ""):
                self.assertIn(reader, (ROOT / "tests/fuzz/CMakeLists.txt").read_text())


if __name__ == "__main__":
    unittest.main()
