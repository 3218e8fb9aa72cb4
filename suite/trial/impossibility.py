"""What a failure of a bound leaves to be asked: can anybody solve the scenario at all?"""

from __future__ import annotations

import math

from scenarios import Scenario


def impossibility(scenario: Scenario) -> dict[str, str | float | None]:
    """The columns of a row that say why nobody can solve ``scenario``, and from when on; None where nothing is proven.

    It is proven for the executable verdict (docs/possible.md). Nothing is proven where a proof only gives a deadline.
    """
    from scenarios.proofs import prove  # hulls need a part of SciPy that no other trial should wait for

    bound = prove(scenario).executable
    is_proven = bound.outcome == "impossible"
    return {
        "impossible_reason": str(bound.reason) if is_proven else None,
        "impossible_from_s": bound.latest_s if is_proven and math.isfinite(bound.latest_s) else None,
    }
