"""Errors a user can make."""


class ScenarioError(ValueError):
    """A scenario, a scenario file or a family's parameters cannot be used; the message is one line for the user."""
