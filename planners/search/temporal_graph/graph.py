"""Temporal graphs and their four path problems.

Wu, Cheng, Huang, Ke, Lu and Xu, "Path Problems in Temporal Graphs", PVLDB 7(9), 2014; the paper's section II-C. An edge
(u, v, t, mu, d) leaves u at t, arrives at v at t + mu and costs d. Ordinary shortest-path algorithms do not apply: a
prefix of a shortest temporal path need not be shortest, because the cheap prefix may arrive too late for the next edge.

One thing differs from Wu et al.: there waiting at a vertex is free and implied. Here it is not, since an arm that waits
among moving obstacles can be hit. An edge may follow another only when it leaves at the very instant the other arrives;
waiting is an edge (u, u, t, 1, 0) like any other. Wu's dominance rule, "arrives no later and costs no more", therefore
shrinks to "arrives at the same time and costs no more". With a waiting edge at every vertex and time the results are
those of Wu et al.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from planners.search.temporal_graph import _kernels

IntArray = npt.NDArray[np.int64]
FloatArray = npt.NDArray[np.float64]


class Window(NamedTuple):
    """A closed interval of discrete times."""

    first: int
    last: int


class TemporalGraph:
    """A directed temporal multigraph as a stream of edges in order of departure."""

    def __init__(
        self,
        n_vertices: int,
        u: npt.ArrayLike,
        v: npt.ArrayLike,
        t: npt.ArrayLike,
        mu: npt.ArrayLike,
        d: npt.ArrayLike,
    ) -> None:
        """Take M edges (u, v, t, mu, d), in any order.

        Args:
            n_vertices: Vertices are 0 to ``n_vertices`` - 1.
            u: Start vertices, shape (M,).
            v: End vertices, shape (M,).
            t: Departures in steps, shape (M,), whole numbers.
            mu: Traversal times in steps, shape (M,), at least 1.
            d: Costs, shape (M,), not negative.

        Raises:
            ValueError: Shapes differ, a vertex is out of range, a mu below 1 or a negative or NaN cost.
        """
        ends = [np.atleast_1d(np.asarray(x, dtype=np.int64)) for x in (u, v, t, mu)]
        cost = np.atleast_1d(np.asarray(d, dtype=np.float64))
        if any(x.shape != cost.shape for x in ends):
            raise ValueError("edges: u, v, t, mu and d must have one shape (M,)")
        if len(cost) and (min(ends[0].min(), ends[1].min()) < 0 or max(ends[0].max(), ends[1].max()) >= n_vertices):
            raise ValueError(f"edges: found a vertex outside 0 to {n_vertices - 1}")
        if (ends[3] < 1).any() or not (cost >= 0).all():
            raise ValueError("edges: mu must be at least 1 and d must not be negative or NaN")
        if (ends[2][1:] < ends[2][:-1]).any():
            order = np.argsort(ends[2], kind="stable")
            ends, cost = [x[order] for x in ends], cost[order]
        self.n_vertices = n_vertices
        self.u, self.v, self.t, self.mu = ends
        self.d = cost
        self.times, self._departure, self._arrival = _numbered(self.t, self.t + self.mu)

    def earliest_arrival(self, source: int, departures: Window, arrive_by: int) -> FloatArray:
        """Earliest arrival at each vertex of paths that leave ``source`` within ``departures``: (n,), inf if none."""
        starts = self._latest_starts(source, departures, arrive_by)
        return np.asarray(np.where(starts >= 0, self._times(arrive_by), np.inf).min(axis=1, initial=np.inf))

    def latest_departure(self, target: int, departures: Window, arrive_by: int) -> FloatArray:
        """Latest departure from each vertex of paths that reach ``target`` by ``arrive_by``: (n,), -inf if none."""
        last = int(np.searchsorted(self.times, arrive_by, side="right")) - 1
        reached = _kernels.reaches(
            self.u, self.v, self._departure, self._arrival, self.n_vertices, len(self.times), target, 0, last
        )
        inside = (self.times >= departures.first) & (self.times <= departures.last)
        return np.asarray(np.where(reached & inside, self.times, -np.inf).max(axis=1, initial=-np.inf))

    def fastest(self, source: int, departures: Window, arrive_by: int) -> FloatArray:
        """Least time from departure to arrival at each vertex: (n,), inf if there is no path."""
        starts = self._latest_starts(source, departures, arrive_by)
        left = np.append(self.times, 0)[starts]  # -1 reads the 0 put at the end and is masked below
        return np.asarray(np.where(starts >= 0, self._times(arrive_by) - left, np.inf).min(axis=1, initial=np.inf))

    def shortest(self, source: int, departures: Window, arrive_by: int) -> FloatArray:
        """Least cost to each vertex: (n,), inf if there is no path."""
        cost, _ = self._shortest(source, departures)
        cost[:, self.times > arrive_by] = np.inf
        return np.asarray(cost.min(axis=1, initial=np.inf))

    def shortest_path(self, source: int, target: int, departures: Window, arrive_by: int) -> IntArray | None:
        """Edges of a cheapest path, the earliest arrival among equals; None if there is no path.

        A path has at least one edge, so from a vertex to itself it is a way back or a wait. Edge numbers refer to this
        graph's arrays ``u``, ``v``, ``t``, ``mu``, ``d``.
        """
        cost, via = self._shortest(source, departures)
        options = np.where((via[target] >= 0) & (self.times <= arrive_by), cost[target], np.inf)
        if not np.isfinite(options).any():
            return None
        edge = int(via[target, int(np.argmin(options))])
        path: list[int] = []
        while edge >= 0:
            path.append(edge)
            edge = int(via[self.u[edge], self._departure[edge]])
        return np.array(path[::-1])

    def _shortest(self, source: int, departures: Window) -> tuple[FloatArray, IntArray]:
        first, last = self._numbers(departures)
        result: tuple[FloatArray, IntArray] = _kernels.shortest(
            self.u, self.v, self._departure, self._arrival, self.d,
            self.n_vertices, len(self.times), source, first, last,
        )  # fmt: skip
        return result

    def _latest_starts(self, source: int, departures: Window, arrive_by: int) -> IntArray:
        first, last = self._numbers(departures)
        starts: IntArray = _kernels.latest_starts(
            self.u, self.v, self._departure, self._arrival, self.n_vertices, len(self.times), source, first, last
        )
        starts[:, self.times > arrive_by] = _kernels.NONE
        return starts

    def _times(self, arrive_by: int) -> FloatArray:
        return np.where(self.times <= arrive_by, self.times, np.inf)

    def _numbers(self, window: Window) -> tuple[int, int]:
        first = int(np.searchsorted(self.times, window.first))
        return first, int(np.searchsorted(self.times, window.last, side="right")) - 1


def _numbered(departures: IntArray, arrivals: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """The distinct times in order, and the number among them of each departure and each arrival.

    Every step between the first time and the last is one, where that is not many more: it spares the sort.
    """
    if not len(departures):
        return departures, departures, arrivals
    first, last = departures.min(), arrivals.max()
    if last - first <= 2 * len(departures):
        return np.arange(first, last + 1), departures - first, arrivals - first
    times = np.unique(np.concatenate([departures, arrivals]))
    return times, np.searchsorted(times, departures), np.searchsorted(times, arrivals)
