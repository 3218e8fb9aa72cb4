"""Path problems in a temporal graph, as one pass over its edges in order of departure.

Labels live on pairs (vertex, time): ``n_times`` distinct departure and arrival times are numbered in order, and
``departure`` and ``arrival`` hold these numbers per edge. An edge may follow another only at the very instant the other
arrives, so of two labels on the same pair the better one dominates, and labels on different pairs never do.
"""

import numpy as np

from scenarios.kernels.jit import kernel

NONE = -1


@kernel
def shortest(u, v, departure, arrival, d, n_vertices, n_times, source, first, last):
    """Least cost from ``source``, left at a time numbered ``first`` to ``last``, to each (vertex, time).

    Returns:
        Costs (n_vertices, n_times), inf where there is no path, and the last edge of a best path (NONE at its start).
    """
    cost = np.full((n_vertices, n_times), np.inf)
    via = np.full((n_vertices, n_times), NONE, dtype=np.int64)
    for time in range(first, last + 1):
        cost[source, time] = 0.0
    for e in range(u.shape[0]):
        candidate = cost[u[e], departure[e]] + d[e]
        # Strictly better only, so that the earliest edge in the stream wins a tie.
        if candidate < cost[v[e], arrival[e]]:
            cost[v[e], arrival[e]] = candidate
            via[v[e], arrival[e]] = e
    return cost, via


@kernel
def latest_starts(u, v, departure, arrival, n_vertices, n_times, source, first, last):
    """Latest departure from ``source`` among paths to each (vertex, time), as a time's number; NONE without a path."""
    start = np.full((n_vertices, n_times), NONE, dtype=np.int64)
    for time in range(first, last + 1):
        start[source, time] = time
    for e in range(u.shape[0]):
        start[v[e], arrival[e]] = max(start[v[e], arrival[e]], start[u[e], departure[e]])
    return start


@kernel
def reaches(u, v, departure, arrival, n_vertices, n_times, target, first, last):
    """Whether ``target`` can be reached, at a time numbered ``first`` to ``last``, from each (vertex, time)."""
    reached = np.zeros((n_vertices, n_times), dtype=np.bool_)
    for time in range(first, last + 1):
        reached[target, time] = True
    for e in range(u.shape[0] - 1, -1, -1):
        if reached[v[e], arrival[e]]:
            reached[u[e], departure[e]] = True
    return reached
