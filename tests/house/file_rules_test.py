"""No file has more than 400 lines, the library never ends the process (only
colmap_plugin/tool may) and names no option of the program, and nobody cites what a reader does not have."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAX_LINES = 400
FOLDERS = ("src", "cuda", "colmap_plugin", "bench", "tests", "examples", "python", "scripts", "cmake", "patches")
SUFFIXES = {".h", ".cc", ".cu", ".cuh", ".py", ".sh", ".cmake"}
NEVER_ENDS = ("src", "cuda", "colmap_plugin")
MAY_END = "colmap_plugin/tool/"

# Comments and literals, so that words in them do not count.
NOT_CODE = re.compile(
    r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])+'", re.DOTALL
)
# Papers and docs/ can be looked up; numbered specifications and contracts cannot.
# A citation may be broken over lines of a comment.
GAP = r"[\s/#*,:;(]+"
CITES_UNKNOWN = re.compile(
    rf"\b(?:specification|contract)s?{GAP}(?:(?:number|section|appendix)s?{GAP})?(?:\d|[A-E]\b)",
    re.IGNORECASE,
)
ENDS_PROCESS = re.compile(r"\b(_?exit|_Exit|quick_exit|abort|terminate)\s*\(")


def sources(root, folders):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                yield path, path.relative_to(root).as_posix()


def all_sources(root):
    """Of the whole tree, as far as git does not ignore it; an archive has the folders."""
    if not (root / ".git").exists() or not shutil.which("git"):
        return list(sources(root, FOLDERS))
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=root, capture_output=True, text=True)
    if listed.returncode != 0:  # somebody else owns the tree
        return list(sources(root, FOLDERS))
    paths = [(root / name, name) for name in listed.stdout.split("\0")]
    return [(path, name) for path, name in paths if path.suffix in SUFFIXES and path.is_file()]


def long_files(root):
    counts = {
        name: path.read_text(encoding="utf-8").count("\n") for path, name in all_sources(root)
    }
    return [f"{name}: {n} lines" for name, n in counts.items() if n > MAX_LINES]


def process_ends(root):
    found = []
    for path, name in sources(root, NEVER_ENDS):
        if name.startswith(MAY_END) or path.suffix not in {".h", ".cc", ".cu", ".cuh"}:
            continue
        code = NOT_CODE.sub(" ", path.read_text(encoding="utf-8"))
        found += [f"{name}: calls {call}()" for call in ENDS_PROCESS.findall(code)]
    return found


def options_named_by_the_library(root):
    """It has none; src/base/remedies.h says how messages come to name them."""
    return [
        f"{name}: {option}"
        for path, name in sources(root, ("src", "cuda"))
        for option in re.findall(r"--(?:PatchMatchStereo|Hpm)\.\w+", path.read_text(encoding="utf-8"))
    ]


def unknown_citations(root):
    found = []
    for path, name in sources(root, FOLDERS):
        found += [
            f"{name}: {' '.join(cited.split())}"
            for cited in CITES_UNKNOWN.findall(path.read_text(encoding="utf-8"))
        ]
    return found


class FileRules(unittest.TestCase):
    def test_no_file_is_longer_than_400_lines(self):
        self.assertEqual(long_files(ROOT), [])

    def test_only_the_tool_ends_the_process(self):
        self.assertEqual(process_ends(ROOT), [])

    def test_the_library_names_no_option_of_the_program(self):
        self.assertEqual(options_named_by_the_library(ROOT), [])

    def test_every_citation_can_be_looked_up(self):
        self.assertEqual(unknown_citations(ROOT), [])


class TheTestItself(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def test_finds_a_long_file(self):
        self.write("src/engine/fits.cc", "int a;\n" * 400)
        self.assertEqual(long_files(self.root), [])
        self.write("src/engine/long.cc", "int a;\n" * 401)
        self.assertEqual(long_files(self.root), ["src/engine/long.cc: 401 lines"])

    @unittest.skipUnless(shutil.which("git"), "git is not installed")
    def test_finds_a_long_file_wherever_git_does_not_ignore_it(self):
        subprocess.run(["git", "init", "-q"], cwd=self.root, check=True)
        self.write(".gitignore", "/build*/\n")
        self.write("build/made.py", "a = 1\n" * 401)
        self.write("data/make.py", "a = 1\n" * 401)
        self.assertEqual(long_files(self.root), ["data/make.py: 401 lines"])

    def test_finds_exit_and_abort_in_the_library(self):
        self.write("src/engine/run.cc", "if (bad) std::exit(1);\n")
        self.write("colmap_plugin/formats/map_file.cc", "abort();\n")
        self.write("cuda/launch.cu", "::_exit (1);\n")
        self.assertEqual(len(process_ends(self.root)), 3)

    def test_finds_an_option_in_the_library(self):
        self.write("src/engine/plan.cc", 'Fail("set " "--Hpm.device cpu");\n')
        self.write("colmap_plugin/tool/help.cc", 'Say("--Hpm.device");\n')
        self.assertEqual(
            options_named_by_the_library(self.root), ["src/engine/plan.cc: --Hpm.device"]
        )

    def test_words_in_comments_and_strings_do_not_count(self):
        self.write("src/engine/run.cc", '// exit(1)\n/* abort() */ Log("exit(1)"); loop_exit();\n')
        self.assertEqual(process_ends(self.root), [])

    def test_finds_citations_of_unknown_documents(self):
        for document in ("specification", "Contract"):
            for place in ("7.1.", "section 10.1)", "number 13", "\n// appendix B", "\n//   3"):
                with self.subTest(document + place):
                    self.write("src/core/plane.h", f"// as in {document} {place}\n")
                    self.assertEqual(len(unknown_citations(self.root)), 1)
        self.write("src/core/plane.h", "// Paper, section 3.2. A contract that 3 sign.\n")
        self.assertEqual(unknown_citations(self.root), [])

    def test_the_tool_may_exit(self):
        self.write("colmap_plugin/tool/main.cc", "_exit(130);\n")
        self.assertEqual(process_ends(self.root), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
