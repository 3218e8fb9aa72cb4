"""The audit: whether an executed motion was free and possible, by code that shares no kernel with the planners."""

from suite.auditor.certificate import clearance, collides
from suite.auditor.judge import audit
from suite.auditor.verdicts import Audit, Contact, Kind, Verdict

__all__ = ["Audit", "Contact", "Kind", "Verdict", "audit", "clearance", "collides"]
