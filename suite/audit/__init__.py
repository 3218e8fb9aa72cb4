"""The audit: whether an executed motion was free and possible, by code that shares no kernel with the planners."""

from suite.audit.certificate import clearance, collides
from suite.audit.judge import audit
from suite.audit.verdicts import Audit, Kind, Verdict

__all__ = ["Audit", "Kind", "Verdict", "audit", "clearance", "collides"]
