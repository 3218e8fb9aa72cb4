"""What a user can get wrong about a run: one line, found before anything is written."""

from __future__ import annotations

from pydantic import ValidationError

from scenarios.errors import UserError


class SuiteError(UserError):
    """A run, a table or a file of one cannot be had like this."""


def one_line(error: ValidationError) -> str:
    """The first finding of a pydantic validation: field, what was found and what is allowed."""
    finding = error.errors(include_url=False)[0]
    if finding["type"] == "value_error":  # raised by a validator of ours, whose message is already whole
        return str(finding["ctx"]["error"])
    field = ".".join(part for part in finding["loc"] if isinstance(part, str))  # the value tells which of a list it is
    return f"{field}: found {finding['input']!r}, allowed: {finding['msg']}"
