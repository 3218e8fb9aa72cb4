"""Several values where one may stand: ``1,3,5``, ``1..10``, ``0.005..0.03/6`` and, among settings, ``2|4|8``."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from scenarios.spec import parse_spec, split_specs
from suite.errors import SuiteError

MAX_VALUES = 1000
"""Of one condition."""

_NUMBER = r"-?\d{1,20}(?:\.\d{1,20})?(?:[eE][+-]?\d{1,2})?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})(?:/(\d{{1,9}}))?")
ALLOWED = "numbers such as 1,3 or ranges such as 1..10 (whole numbers) and 0.005..0.03/6 (six values)"


def expand(text: str) -> list[str]:
    """The values that a text stands for: a range's, or what stands between bars, or the text itself.

    Bounds are decimal numbers and values are exact, so ``0.01..0.03/3`` has the 0.02 that one would type.

    Raises:
        SuiteError: A range that is empty or too long, or whole numbers that are none.
    """
    return [value for part in text.split("|") for value in _expanded(part.strip())]


def _expanded(text: str) -> list[str]:
    match = _RANGE.fullmatch(text)
    if match is None:
        return [text]
    low, high = Fraction(match[1]), Fraction(match[2])
    if match[3] is None and not (low.denominator == high.denominator == 1):
        raise SuiteError(f"found {text!r}, allowed with the number of values, such as {text}/5")
    steps = high - low if match[3] is None else Fraction(int(match[3]) - 1)
    if not (low < high and 1 <= steps < MAX_VALUES):
        raise SuiteError(f"found {text!r}, allowed LOW..HIGH/COUNT with 2 to {MAX_VALUES} values that ascend")
    return [_decimal(low + (high - low) * k / steps) for k in range(int(steps) + 1)]


def _decimal(value: Fraction) -> str:
    return str(int(value)) if value.denominator == 1 else repr(float(value))


def expand_spec(spec: str) -> list[str]:
    """Every combination of what a spec's settings stand for: ``orbit[max_speed_m_s=0.01|0.02]`` is two.

    Raises:
        SpecError, SuiteError: It is no spec, or has a range that is none.
    """
    if not ("|" in spec or ".." in spec.partition("[")[2]):
        return [spec]
    name, settings = parse_spec(spec)
    choices = [[f"{key}={value}" for value in expand(text)] for key, text in settings.items()]
    count = 1
    for choice in choices:
        count *= len(choice)
    if count > MAX_VALUES:
        raise SuiteError(f"{name}: found {count} combinations of settings, allowed {MAX_VALUES}")
    return [f"{name}[{','.join(chosen)}]" for chosen in itertools.product(*choices)]


def with_setting(spec: str, key: str, values: Any) -> str:
    """The spec with one more setting, which may stand for several values; a setting of that key gives way.

    Raises:
        SpecError: It is no spec.
    """
    name, settings = parse_spec(spec)
    return spec_text(name, settings | {key: values})


def spec_text(name: str, settings: Mapping[str, Any]) -> str:
    """``name[key=value,...]`` from values that may be lists."""
    inside = ",".join(f"{key}={_bars(value)}" for key, value in settings.items())
    return f"{name}[{inside}]" if inside else name


def _bars(value: Any) -> str:
    values: Iterable[Any] = value if isinstance(value, list | tuple) else [value]
    return "|".join(str(each) for each in values)


def listed(value: Any) -> tuple[Any, ...]:
    """One value, a list of them, or a text of several, as a tuple; ranges are expanded.

    Raises:
        SuiteError: A range that is none, or an entry that is empty.
    """
    if isinstance(value, str):
        parts = [part.strip() for part in value.split(",")]
        if not all(parts):
            raise SuiteError(f"found {value!r}, allowed {ALLOWED}")
        return tuple(each for part in parts for each in expand(part))
    if isinstance(value, list | tuple):
        return tuple(each for part in value for each in (listed(part) if isinstance(part, str) else (part,)))
    return (value,)


def specs_of(values: Any) -> tuple[str, ...]:
    """Planners or families from a text in which they stand between commas, a mapping, or a list of either.

    Raises:
        SpecError, SuiteError: One of them is no spec.
    """
    parts = [part for text in _texts(values) for part in (split_specs(text) if text.strip() else [text])]
    return tuple(spec for part in parts for spec in expand_spec(part))


def arms_of(values: Any) -> tuple[str, ...]:
    """Arms from a text of settings, a mapping, or a list of either.

    Raises:
        SpecError, SuiteError: One of them is none.
    """
    return tuple(_inside(spec) for text in _texts(values) for spec in expand_spec(f"arm[{text}]"))


def _inside(spec: str) -> str:
    return spec.partition("[")[2].removesuffix("]")


def _texts(values: Any) -> tuple[str, ...]:
    """One text or mapping of settings, or a list of them, as texts."""
    given = values if isinstance(values, list | tuple) else (values,)
    return tuple(_text(value) for value in given)


def _text(value: Any) -> str:
    """A spec, which files may write as a mapping: its name, if it has one, under ``name``."""
    if isinstance(value, Mapping):
        settings = {str(key): each for key, each in value.items() if key != "name"}
        return spec_text(str(value["name"]), settings) if "name" in value else _inside(spec_text("arm", settings))
    if not isinstance(value, str):
        raise SuiteError(f"found {value!r}, allowed a text such as name[key=value,...]")
    return value
