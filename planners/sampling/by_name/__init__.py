"""Any geometric planner that the installed OMPL binds, by its name: ``ompl.KPIECE1``.

Which there are, and what can be set on each, is read from OMPL's bindings. Each is used as ``rrt`` is: attempts at one
goal configuration after another, within a part of space-time. What a planner needs beside (``treatment``), and the few
that can't work here, were found by trying them.
"""

import copy
import difflib
import functools
import types
from importlib.metadata import version
from typing import Any

from pydantic import Field, create_model
from pydantic.fields import FieldInfo

from planners.sampling.by_name.guest import GuestPlanner, GuestSettings, ProjectedSettings
from planners.sampling.by_name.setters import Setter, bound_planners, setters_of
from planners.sampling.by_name.treatment import LEAST, OMITTED, REFUSED, TREATMENTS, Treatment
from scenarios.spec import SpecError

PREFIX = "ompl."

_SHARES = ("_bias", "_fraction", "_threshold")
"""Ends of names of settings that are shares."""


def is_guest(name: str) -> bool:
    """Whether a planner's name is one of OMPL's."""
    return name.startswith(PREFIX)


def ompl_planners() -> dict[str, type[GuestPlanner]]:
    """Every planner of OMPL's that works here, by its name in specs."""
    return {PREFIX + name: guest_planner(PREFIX + name) for name in bound_planners() if name not in REFUSED}


def ompl_refused() -> dict[str, str]:
    """Why the others that the installed OMPL binds can't work here, by their names in specs."""
    return {PREFIX + name: reason for name, reason in REFUSED.items() if name in bound_planners()}


def known_guest(name: str) -> str:
    """Return ``name`` if it names a planner of OMPL's that works here.

    Raises:
        SpecError: It does not; the message lists those that do, and says why this one can't or which is nearest.
    """
    working = [PREFIX + bound for bound in bound_planners() if bound not in REFUSED]
    if name in working:
        return name
    short = name.removeprefix(PREFIX)
    if short in REFUSED:
        hint = f"; {short} can't work here: {REFUSED[short]}"
    else:
        by_small_letters = {bound.lower(): bound for bound in bound_planners()}
        nearest = difflib.get_close_matches(short[:100].lower(), by_small_letters, 1)
        hint = f"; nearest: {PREFIX}{by_small_letters[nearest[0]]}" if nearest else ""
    raise SpecError(f"planner: found {name!r}, allowed {', '.join(working)}{hint}")


@functools.cache
def guest_planner(name: str) -> type[GuestPlanner]:
    """The class of a planner of OMPL's, by its name in specs."""
    short = name.removeprefix(PREFIX)
    attributes: dict[str, Any] = {
        "__doc__": f"OMPL's {short}.",
        "__module__": __name__,
        "name": name,
        "guest": short,
        "settings_model": settings_model(short),
        "summary": f"OMPL's {short} in space-time, replanned when the prediction invalidates the path",
        "source": TREATMENTS.get(short, Treatment()).source or f"OMPL {version('ompl')}",
    }
    made: type[GuestPlanner] = types.new_class(
        f"{short}Planner", (GuestPlanner,), exec_body=lambda body: body.update(attributes)
    )
    return made


@functools.cache
def settings_model(short: str) -> type[GuestSettings]:
    """Its settings: OMPL's setters with defaults that suit this space, and what all guests share."""
    base = ProjectedSettings if hasattr(bound_planners()[short], "setProjectionEvaluator") else GuestSettings
    defaults: dict[str, Any] = dict(TREATMENTS.get(short, Treatment()).defaults)
    fields: dict[str, Any] = {}
    for setter in setters_of(short):
        if setter.key not in OMITTED and setter.key not in base.model_fields:
            default = defaults.pop(setter.key, setter.default)
            fields[setter.key] = (setter.kind, _field(setter, 1000.0 if setter.key == "range" else default))
    for key, default in defaults.items():
        shared = copy.copy(base.model_fields[key])
        shared.default = default
        fields[key] = (shared.annotation, shared)
    create: Any = create_model  # pydantic's mypy plugin would take the result for a class statement
    model: type[GuestSettings] = create(f"{short}Settings", __base__=base, __module__=__name__, **fields)
    model.guest = short
    model.__doc__ = f"Settings of ``{PREFIX}{short}``."
    return model


def _field(setter: Setter, default: Any) -> FieldInfo:
    """Limits that keep a search bounded; for the rest OMPL is asked."""
    limits: dict[str, Any] = {}
    if setter.kind is int:
        limits = {"ge": 1, "le": 10_000}
    elif setter.kind is float:
        limits = {"ge": LEAST.get(setter.key, 0.0), "le": 1 if setter.key.endswith(_SHARES) else 1000}
    made: FieldInfo = Field(default=default, description=f"OMPL's set{setter.name}", **limits)
    return made


def __getattr__(name: str) -> type[GuestSettings]:
    """Settings models by their names: unpickling looks them up."""
    short = name.removesuffix("Settings")
    if short != name and short in bound_planners():
        return settings_model(short)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
