"""The one notation for a thing with settings: ``name`` or ``name[key=value,...]``."""

import difflib
import re
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from scenarios.errors import UserError

_Settings = TypeVar("_Settings", bound=BaseModel)
_NAME = re.compile(r"[^\s\[\],=][^\[\],=]*")


class SpecError(UserError):
    """A spec cannot be read or names something unknown; the message lists what is known."""


def split_specs(text: str) -> list[str]:
    """Split a comma-separated list of specs; commas inside brackets belong to their spec."""
    entries, depth = [list[str]()], 0
    for piece in re.split(r"([\[\],])", text):
        if piece == "," and depth <= 0:
            entries.append([])
        else:
            depth += {"[": 1, "]": -1}.get(piece, 0)
            entries[-1].append(piece)
    parts = ["".join(entry).strip() for entry in entries]
    if not all(parts):
        raise SpecError(f"found an empty entry in {text!r}, allowed a comma-separated list of name[key=value,...]")
    return parts


def parse_spec(text: str) -> tuple[str, dict[str, str]]:
    """Split ``name[key=value,...]`` into its name and its settings as text.

    Raises:
        SpecError: The text is not of that form, or a key stands twice.
    """
    name, opened, rest = (part.strip() for part in text.partition("["))
    inside = rest.removesuffix("]")
    if not _NAME.fullmatch(name) or (opened and rest == inside) or "[" in inside or "]" in inside:
        raise SpecError(f"found {text!r}, allowed name or name[key=value,...]")
    settings: dict[str, str] = {}
    for item in inside.split(",") if inside.strip() else []:
        key, equals, value = (part.strip() for part in item.partition("="))
        if not (key and equals and value):
            raise SpecError(f"{name}: found {item.strip()!r}, allowed key=value")
        if key in settings:
            raise SpecError(f"{name}: found {key!r} twice, allowed once")
        settings[key] = value
    return name, settings


def known_name(kind: str, name: str, known: Iterable[str]) -> str:
    """Return ``name`` if it is known.

    Raises:
        SpecError: It is not; the message lists the known ones and names the nearest.
    """
    names = list(known)
    if name not in names:
        nearest = difflib.get_close_matches(name[:100], names, 1)
        hint = f"; nearest: {nearest[0]}" if nearest else ""
        raise SpecError(f"{kind}: found {name!r}, allowed {', '.join(names)}{hint}")
    return name


def parse_settings(name: str, model: type[_Settings], values: Mapping[str, Any]) -> _Settings:
    """Build a settings model from values, which may be texts.

    Raises:
        SpecError: An unknown key or a value out of range; the message lists the known keys or the allowed values.
    """
    unknown = [key for key in values if key not in model.model_fields]
    if unknown:
        known = ", ".join(model.model_fields) or "none"
        nearest = difflib.get_close_matches(unknown[0][:100], model.model_fields, 1)
        hint = f"; nearest: {nearest[0]}" if nearest else ""
        raise SpecError(f"{name}: found setting {unknown[0]!r}, allowed {known}{hint}")
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "settings"
        raise SpecError(f"{name}[{where}]: found {first['input']!r}, allowed: {first['msg']}") from None
