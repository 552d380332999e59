"""HPM-MVS dense stereo, a drop-in for COLMAP's patch_match_stereo.

patch_match_stereo() works on a COLMAP workspace, estimate() on arrays; docs/python.md has
examples. The wheel brings the program hpm_mvs, too.
"""
from importlib.metadata import version as _version

from ._core import (
    DeviceError,
    Error,
    Failure,
    InputError,
    InterruptedRunError,
    LockedError,
    NotReadyError,
    PartialError,
    PatchMatchOptions,
    ProgressEvent,
    ResourcesError,
    RunSummary,
    UsageError,
    patch_match_stereo,
)
from ._estimate import Estimate, estimate

__version__ = _version("hpm-mvs")
__all__ = [
    "DeviceError",
    "Error",
    "Estimate",
    "Failure",
    "InputError",
    "InterruptedRunError",
    "LockedError",
    "NotReadyError",
    "PartialError",
    "PatchMatchOptions",
    "ProgressEvent",
    "ResourcesError",
    "RunSummary",
    "UsageError",
    "estimate",
    "patch_match_stereo",
]
