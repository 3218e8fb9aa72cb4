"""Errors a user can make: one line each, fit for any terminal."""

LONGEST_MESSAGE = 320
"""Characters of a message; of a longer one the middle is left out, since both ends say what matters."""


class UserError(ValueError):
    """A mistake the user can mend; the message is one line, whatever stood in the user's file."""

    def __init__(self, message: str) -> None:
        """Say ``message``, shortened and with what a terminal cannot show escaped."""
        super().__init__(shortened(printable(shortened(message))))


class ScenarioError(UserError):
    """A scenario, a scenario file or a family's parameters cannot be used."""


class FileError(UserError):
    """A file cannot be read: it is not there, not of the right kind, too large, or not what its name says."""


def printable(text: str) -> str:
    r"""The same with control characters, line ends and halves of characters written as ``\x1b`` or ``\ud800``."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def shortened(text: str, longest: int = LONGEST_MESSAGE) -> str:
    """The same without its middle, should it be too long."""
    if len(text) <= longest:
        return text
    half = (longest - 5) // 2
    return f"{text[:half]} ... {text[-half:]}"
