"""PatchMatchOptions of the Python package, and what may be given in its place."""
import pathlib
import unittest

import hpm_mvs

try:
    import pycolmap
except ImportError:
    pycolmap = None


class Options(unittest.TestCase):
    def test_have_the_defaults_of_the_program(self):
        options = hpm_mvs.PatchMatchOptions()
        self.assertEqual(repr(options), "PatchMatchOptions()")
        self.assertEqual(options.todict(), {})
        self.assertIs(options.geom_consistency, True)
        self.assertEqual((options.window_radius, options.depth_min, options.gpu_index), (5, -1, "-1"))
        self.assertEqual((options.hpm.method, options.hpm.mask_path), ("hpm_plus", ""))

    def test_are_set_by_attribute_name_and_keyword(self):
        options = hpm_mvs.PatchMatchOptions(max_image_size=1600, **{"Hpm.quality": "low"})
        options.filter = False
        options.hpm.mask_path = pathlib.Path("masks")
        options["PatchMatchStereo.depth_min"] = 1
        options["depth_max"] = 2.5
        options["random_seed"] = 7
        expected = {
            "max_image_size": 1600, "Hpm.quality": "low", "filter": False, "Hpm.mask_path": "masks",
            "depth_min": 1, "depth_max": 2.5, "random_seed": 7,
        }
        self.assertEqual(options.todict(), expected)
        self.assertEqual(hpm_mvs.PatchMatchOptions(options).todict(), expected)
        self.assertEqual(hpm_mvs.PatchMatchOptions(options.todict()).todict(), expected)
        self.assertEqual(options["Hpm.quality"], options.hpm.quality)

    def test_a_copy_is_a_copy(self):
        options = hpm_mvs.PatchMatchOptions(max_image_size=1)
        copy = hpm_mvs.PatchMatchOptions(options, max_image_size=2)
        self.assertEqual((options.max_image_size, copy.max_image_size), (1, 2))

    def test_an_unknown_name_gets_the_nearest(self):
        nearest = {
            "max_imag_size": "max_image_size",
            "PatchMatchStereo.filter_ncc": "filter_min_ncc",
            "method": "Hpm.method",
            "Hpm.qualty": "Hpm.quality",
        }
        for name, near in nearest.items():
            with self.subTest(name), self.assertRaisesRegex(
                hpm_mvs.UsageError, f"'{name}'; did you mean '{near}'"
            ):
                hpm_mvs.PatchMatchOptions({name: 1})
        with self.assertRaises(AttributeError):
            hpm_mvs.PatchMatchOptions().max_imag_size = 3

    def test_what_is_an_argument_or_of_the_command_line_is_no_option(self):
        for name in ("workspace_path", "config_path", "project_path", "log_level", "Hpm.log_format"):
            with self.subTest(name), self.assertRaises(hpm_mvs.UsageError):
                hpm_mvs.PatchMatchOptions({name: "x"})

    def test_a_value_that_is_not_allowed_names_what_is(self):
        wrong = {"window_radius": 0, "max_image_size": 3.5, "filter": "perhaps", "filter_min_ncc": None,
                 "Hpm.method": "best", "gpu_index": [0, 1], "depth_min": float("nan")}
        for name, value in wrong.items():
            with self.subTest(name), self.assertRaisesRegex(
                hpm_mvs.UsageError, f"^{name} .* is not allowed; allowed: "
            ):
                hpm_mvs.PatchMatchOptions({name: value})
        with self.assertRaisesRegex(hpm_mvs.UsageError, "window_radius '99'"):
            hpm_mvs.PatchMatchOptions().window_radius = 99
        with self.assertRaisesRegex(hpm_mvs.UsageError, "PatchMatchOptions"):
            hpm_mvs.PatchMatchOptions(5)


@unittest.skipIf(pycolmap is None, "pycolmap is not installed")
class OptionsOfPycolmap(unittest.TestCase):
    def test_only_what_was_set_counts(self):
        theirs = pycolmap.PatchMatchOptions()
        self.assertEqual(hpm_mvs.PatchMatchOptions(theirs).todict(), {})
        theirs.max_image_size = 2000
        theirs.geom_consistency = False
        self.assertEqual(
            hpm_mvs.PatchMatchOptions(theirs).todict(),
            {"max_image_size": 2000, "geom_consistency": False},
        )

    def test_all_of_theirs_are_ours(self):
        ours = hpm_mvs.PatchMatchOptions()
        self.assertEqual([n for n in pycolmap.PatchMatchOptions().todict() if not hasattr(ours, n)], [])


class FromTheFuture:
    def __init__(self):
        self.new_option, self.window_radius = 1, 5

    def todict(self):
        return dict(vars(self))


class OptionsOfOthers(unittest.TestCase):
    def test_an_unknown_one_matters_only_if_it_was_set(self):
        theirs = FromTheFuture()
        self.assertEqual(hpm_mvs.PatchMatchOptions(theirs).todict(), {})
        theirs.new_option = 2
        with self.assertRaisesRegex(hpm_mvs.UsageError, "new_option"):
            hpm_mvs.PatchMatchOptions(theirs)


if __name__ == "__main__":
    unittest.main()
