"""A planner to start from: the file and its test that ``suite new-planner`` writes are the ones beside this one."""

from __future__ import annotations

import importlib.util
import keyword
import re
import sys
from importlib.resources import files
from pathlib import Path

from suite.errors import SuiteError

_NAME = re.compile(r"(?=.{1,40}$)[a-z][a-z0-9]*(_[a-z0-9]+)*")
_MODULE, _CLASS = "new_planner", "NewPlanner"


def class_name(name: str) -> str:
    """The class of a planner called ``name``: ``my_planner`` is ``MyPlanner``."""
    return "".join(part.capitalize() for part in name.split("_"))


def write_planner(name: str, folder: Path) -> tuple[Path, Path]:
    """Write ``name.py`` with one planner class, and ``test_name.py`` beside it; returns both.

    Raises:
        SuiteError: A name that no module can have or that hides another module, or a file that is there.
    """
    if not _NAME.fullmatch(name) or keyword.iskeyword(name) or not class_name(name).isidentifier():
        raise SuiteError(f"name: found {name[:60]!r}, allowed a module's, small letters, digits and _, such as mine")
    planner, test = folder / f"{name}.py", folder / f"test_{name}.py"
    for file in (planner, test):
        if file.exists():
            raise SuiteError(f"{file}: found a file there, allowed a name without one")
    if name in sys.stdlib_module_names or importlib.util.find_spec(name) is not None:
        raise SuiteError(f"name: found {name!r}, which would hide a module of that name, allowed another")
    for file, template in ((planner, f"{_MODULE}.py"), (test, f"test_{_MODULE}.py")):
        text = files(__name__).joinpath(template).read_text(encoding="utf-8")
        for ours, theirs in ((f"{__name__}.{_MODULE}", name), (_CLASS, class_name(name)), (_MODULE, name)):
            text = text.replace(ours, theirs)
        _write_new(file, text)
    return planner, test


def _write_new(file: Path, text: str) -> None:
    try:
        with file.open("x", encoding="utf-8", newline="\n") as handle:
            handle.write(text)
    except OSError as error:
        raise SuiteError(f"{file}: found {error.strerror}, allowed a folder that can be written to") from None
