import numpy as np
from audit_twin import random_motion

from suite.auditor import Kind, audit
from suite.auditor._kernels import KEPT_SHARE
from suite.auditor.fcl_engine import sampled_contacts

# What FCL may miss: arcs bow 0.1 mm beyond its chords, and between two of its samples, 10 ms apart, body and obstacle,
# at no more than 0.8 m/s, come at most 4 mm nearer.
FCL_MISSES_M = 4.1e-3


def test_certificate_and_fcl_agree_on_thousands_of_motions():
    """What FCL hits is certified as hit, no later; what it sees clear by more than it can miss is certified free."""
    rng = np.random.default_rng(11)
    touched = clear = 0
    for _ in range(2000):
        motion = random_motion(rng)
        certified, sampled = audit(*motion), audit(*motion, sampled_contacts)
        free = certified.swept.violation_kind != Kind.COLLISION
        seen_free = sampled.swept.violation_kind != Kind.COLLISION
        if free:
            clear += 1
            assert seen_free
            assert sampled.min_clearance_m >= KEPT_SHARE * certified.min_clearance_m
        if not seen_free:
            touched += 1
            assert not free
            assert certified.swept.violation_time_s <= sampled.swept.violation_time_s
        if sampled.min_clearance_m > FCL_MISSES_M:
            assert free
    assert min(touched, clear) > 300
