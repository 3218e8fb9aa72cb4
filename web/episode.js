// A scenario and trials, decoded: questions about an instant.

import { backbone, tip } from "./arm.js";
import { before, rowAt, unpack } from "./unpack.js";

const ROUND = { sphere: true };

/** The obstacles' true motion, and how near an arm is to them. */
export async function decodeScenario(scenario) {
  const centers = await unpack(scenario.trace.centers);
  const { start, step } = scenario.trace;
  const count = scenario.shapes.length;
  return {
    ...scenario,
    count,
    centers: (time) => triples(rowAt(centers, (time - start) / step)),
    trail: (j, from, to, n = 24) =>
      Array.from({ length: n + 1 }, (_, k) => {
        const row = rowAt(centers, (from + ((to - from) * k) / n - start) / step);
        return row.slice(3 * j, 3 * j + 3);
      }),
    allRound: scenario.shapes.every((shape) => ROUND[shape.kind]),
  };
}

export async function decodeTrial(trial, scenario) {
  const [times, states] = await Promise.all([unpack(trial.times), unpack(trial.states)]);
  const looks = trial.looks && (await decodeLooks(trial.looks, scenario));
  const state = (time) => stateAt(times.values, states, time);
  const tips = Array.from(times.values, (_, k) => tip(rowAt(states, k), scenario.arm));
  return { ...trial, end: times.values.at(-1), state, looks, tipTimes: times.values, tips };
}

function stateAt(times, states, time) {
  const k = before(times, time);
  const next = Math.min(k + 1, times.length - 1);
  const span = times[next] - times[k];
  return rowAt(states, k + (span > 0 ? Math.min(Math.max((time - times[k]) / span, 0), 1) : 0));
}

async function decodeLooks(looks, scenario) {
  const [centers, radii, pathTimes, paths] = await Promise.all(
    [looks.centers, looks.radii, looks.path_times, looks.paths].map(unpack),
  );
  const starts = looks.counts.map((_, k) => looks.counts.slice(0, k).reduce((a, b) => a + b, 0));
  const pathStarts = looks.lengths.map((_, k) => looks.lengths.slice(0, k).reduce((a, b) => a + b, 0));
  const solveAt = (time) => (looks.solves.length && looks.solves[0] <= time + 1e-9 ? before(looks.solves, time) : -1);
  return {
    ...looks,
    solveAt,
    /** What was expected of `time` at the latest look: centres, radii, and the way from then on. */
    expected(time) {
      const k = before(looks.from, time);
      const at = (when) => (when - looks.from[k]) / looks.step;
      const last = looks.from[k] + looks.step * (looks.counts[k] - 1);
      const ahead = [];
      for (let when = time; when < last; when += looks.step / 2)
        ahead.push(triples(rowAt(centers, at(when), starts[k], looks.counts[k])));
      ahead.push(triples(rowAt(centers, at(last), starts[k], looks.counts[k])));
      return {
        looked: looks.from[k],
        last,
        centers: triples(rowAt(centers, at(time), starts[k], looks.counts[k])),
        radii: rowAt(radii, at(time), starts[k], looks.counts[k]),
        ahead,
      };
    },
    /** The states still ahead of `time` on the path of the latest solve. */
    path(time) {
      const k = solveAt(time);
      if (k < 0) return [];
      const rows = [];
      for (let i = pathStarts[k]; i < pathStarts[k] + looks.lengths[k]; i++)
        if (pathTimes.values[i] > time) rows.push(rowAt(paths, i));
      return rows;
    },
  };
}

/** Smallest distance of the arm's surface to a sphere: {metres, obstacle, section}, to a tenth of a millimetre or so. */
export function nearest(frames, arm, perSection, centers, radii) {
  let least = { metres: Infinity, obstacle: -1, section: -1 };
  centers.forEach((center, j) =>
    frames.forEach(({ p }, k) => {
      const metres = Math.hypot(p[0] - center[0], p[1] - center[1], p[2] - center[2]) - radii[j] - arm.radius_m;
      if (metres < least.metres)
        least = { metres, obstacle: j, section: Math.min(Math.max(Math.ceil(k / perSection), 1), arm.n_sections) };
    }),
  );
  return least;
}

export { backbone };

function triples(row) {
  return Array.from({ length: row.length / 3 }, (_, j) => row.slice(3 * j, 3 * j + 3));
}
