"""What the wheel brings beside the module: the program, type hints, the version."""
import ast
import importlib.resources
import pathlib
import subprocess
import sys
import unittest

import hpm_mvs

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = importlib.resources.files("hpm_mvs")
SCRIPT = pathlib.Path(sys.executable).parent / "hpm_mvs"


class Package(unittest.TestCase):
    def test_it_is_the_installed_one(self):
        self.assertNotIn(ROOT / "python", pathlib.Path(hpm_mvs.__file__).parents)

    def test_has_the_version_of_the_tree(self):
        self.assertEqual(hpm_mvs.__version__, (ROOT / "VERSION").read_text().strip())

    def test_the_script_is_the_program(self):
        for command in ([SCRIPT], [sys.executable, "-m", "hpm_mvs"]):
            run = subprocess.run([*command, "version"], stdout=subprocess.PIPE, text=True, check=True)
            self.assertTrue(run.stdout.startswith(f"hpm_mvs {hpm_mvs.__version__}"), run.stdout)
            wrong = subprocess.run([*command, "patch_match_stereo"], stderr=subprocess.PIPE)
            self.assertEqual(wrong.returncode, 2)

    def test_has_type_hints(self):
        self.assertTrue((FILES / "py.typed").is_file())
        tree = ast.parse((FILES / "_core.pyi").read_text())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        members = {node.name for node in classes["PatchMatchOptions"].body
                   if isinstance(node, ast.FunctionDef)}
        self.assertLess({"max_image_size", "geom_consistency", "filter", "hpm"}, members)
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        self.assertIn("patch_match_stereo", functions)

    def test_everything_has_a_docstring(self):
        self.assertEqual([n for n in hpm_mvs.__all__ if not getattr(hpm_mvs, n).__doc__], [])


if __name__ == "__main__":
    unittest.main()
