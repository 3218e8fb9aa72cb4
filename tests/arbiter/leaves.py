"""The places where a planner's kernels decide on a state or a motion, each to be taken by one that asks the court.

To be done in a process of its own, with a cache of compiled kernels of its own, before anything has been compiled:
whoever calls such a kernel is then compiled with the one that asks.
"""

import importlib
import pkgutil
import sys
from collections.abc import Callable
from typing import Any

import planners
from planners.paper.potential_field import _kernels as field
from planners.problem import _kernels as shared
from planners.search import scene
from planners.search.certificate import _kernels as certificate
from planners.search.configurations import _kernels as configurations

from . import asking
from .court import COURT


def put_in_place() -> None:
    """Have every kernel of the planners ask, and everything they ask about noted."""
    for module in pkgutil.walk_packages(planners.__path__, "planners."):
        importlib.import_module(module.name)
    for own, other in (
        (configurations.is_free, asking.is_free),
        (configurations.is_code_free, asking.is_code_free),
        (certificate.is_motion_free, asking.is_motion_free),
        (certificate.is_clear, asking.is_clear),
        (shared.motion_valid, asking.motion_valid),
        (shared.clearance, asking.clearance),
        (field.nearest_on_body, asking.nearest_on_body),
        (scene.scene_of, COURT.noting(scene.scene_of)),
    ):
        _replace(own, other)


def _replace(own: object, other: Callable[..., Any]) -> None:
    """Let ``other`` stand wherever ``own`` stands in the planners, but for the arbiter's own kernels."""
    for name, module in list(sys.modules.items()):
        if name.startswith("planners") and module not in {shared, certificate}:
            for attribute, value in list(vars(module).items()):
                if value is own:
                    setattr(module, attribute, other)
