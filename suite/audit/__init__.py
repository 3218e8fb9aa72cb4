"""The audit: whether an executed motion was free and possible, by code that shares no kernel with the planners."""

from suite.audit.judge import audit, collides
from suite.audit.verdicts import Audit, Kind, Verdict

__all__ = ["Audit", "Kind", "Verdict", "audit", "collides"]
