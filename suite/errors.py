"""What a user can get wrong about a run: one line, found before anything is written."""

from __future__ import annotations

from pydantic import ValidationError


class SuiteError(ValueError):
    """A mistake the user can mend; the message is one line for the terminal."""


def describe(error: ValidationError, of: str) -> str:
    """Put the first finding of a pydantic validation into one line.

    Args:
        error: What pydantic found.
        of: What was validated, such as a file name.
    """
    finding = error.errors(include_url=False)[0]
    where = ".".join(str(part) for part in finding["loc"] if not isinstance(part, int))
    reason = finding["msg"].removeprefix("Value error, ")
    subject = ": ".join(part for part in (of, where) if part)
    return f"{subject}: {reason[0].lower()}{reason[1:]} (found {finding['input']!r})"
