"""What can be set on one of OMPL's planners, read from the signatures of its bindings."""

import functools
import re
from typing import NamedTuple

from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

Value = float | int | bool

_KINDS: dict[str, type[Value]] = {"float": float, "int": int, "bool": bool}
_SETTER = re.compile(rf"def set(\w+)\(self, \w+: ({'|'.join(_KINDS)})(?:, /)?\) -> None")
_WORD = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


class Setter(NamedTuple):
    """One thing that can be set."""

    key: str
    """What the setting is called: ``goal_bias`` for ``setGoalBias``."""
    name: str
    """``GoalBias``, which ``set`` and ``get`` go before."""
    kind: type[Value]
    default: Value
    """What a fresh planner has."""

    def get(self, planner: ob.Planner) -> Value:
        """The present value."""
        value: Value = getattr(planner, f"get{self.name}")()
        return value

    def set(self, planner: ob.Planner, value: Value) -> None:
        """Set another value."""
        getattr(planner, f"set{self.name}")(value)


@functools.cache
def bound_planners() -> dict[str, type[ob.Planner]]:
    """Every geometric planner that the installed OMPL binds, by its class's name."""
    classes = sorted((name, kind) for name, kind in vars(og).items() if isinstance(kind, type))
    return {name: kind for name, kind in classes if issubclass(kind, ob.Planner) and kind is not ob.Planner}


@functools.cache
def setters_of(name: str) -> tuple[Setter, ...]:
    """All that takes one number or truth value and can be read again, in OMPL's order of names."""
    kind, fresh = bound_planners()[name], fresh_planner(name)
    found = []
    for method in sorted(dir(kind)):
        for signature, *_ in getattr(getattr(kind, method), "__nb_signature__", None) or ():
            match = _SETTER.fullmatch(signature)
            if match and hasattr(kind, f"get{match[1]}"):
                key = _WORD.sub("_", match[1]).lower()
                found.append(Setter(key, match[1], _KINDS[match[2]], getattr(fresh, f"get{match[1]}")()))
                break
    return tuple(found)


def fresh_planner(name: str) -> ob.Planner:
    """A planner that nothing was set on, in a space of its own: to ask it what it has and what it refuses."""
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    space = ob.RealVectorStateSpace(2)
    space.setBounds(-1.0, 1.0)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(lambda _: True)
    si.setup()
    return bound_planners()[name](si)
