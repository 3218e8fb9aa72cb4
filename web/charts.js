// Small charts in SVG: lines with bands, steps, stacked bars. Values in, elements out.

import { h, svg } from "./dom.js";
import { PLANNERS } from "./look.js";

const [W, H] = [420, 250];
const BOX = { left: 44, right: 12, top: 12, bottom: 36 };
const DASHES = ["", "6 3", "2 3"];

/** A planner's colour and dash, the same in every chart. */
export function style(position) {
  return {
    color: PLANNERS[position % PLANNERS.length],
    dash: DASHES[Math.floor(position / PLANNERS.length) % DASHES.length],
  };
}

export function key(names) {
  return h(
    "p",
    { class: "legend" },
    ...names.map((name, k) =>
      h(
        "span",
        {},
        svg(
          "svg",
          { width: 22, height: 8 },
          svg("line", {
            x1: 0,
            x2: 22,
            y1: 4,
            y2: 4,
            stroke: style(k).color,
            "stroke-width": 3,
            "stroke-dasharray": style(k).dash,
          }),
        ),
        name,
      ),
    ),
  );
}

/** Success over a condition: lines of points [x, y, low, high, n], y in percent, with 95 % bands. */
export function curvePanel(title, over, lines, names) {
  const xs = [...new Set(lines.flatMap((line) => line.points.map(([x]) => x)))].filter((x) => x !== null);
  const numeric = xs.every((x) => typeof x === "number");
  if (numeric) xs.sort((a, b) => a - b);
  const place = (x) =>
    scale(
      numeric ? x : xs.indexOf(x),
      numeric ? xs[0] : 0,
      numeric ? xs.at(-1) : xs.length - 1,
      BOX.left + 16,
      W - BOX.right - 16,
    );
  const height = (y) => scale(y, 0, 100, H - BOX.bottom, BOX.top);
  const parts = lines.map(({ planner, points }) => {
    const { color, dash } = style(names.indexOf(planner));
    const dodge = 2.4 * (names.indexOf(planner) - (names.length - 1) / 2); // so that equal lines can be told apart
    const x0 = (x) => place(x) + (names.length < 12 ? dodge : 0);
    const at =
      points.length === 1 && points[0][0] === null
        ? xs.map((x) => [x, ...points[0].slice(1)])
        : points.filter(([x]) => x !== null);
    const band = [
      ...at.map(([x, , low]) => [x0(x), height(low)]),
      ...at.toReversed().map(([x, , , high]) => [x0(x), height(high)]),
    ];
    const dots = at.map(([x, y, low, high, n]) =>
      svg(
        "circle",
        { cx: x0(x), cy: height(y), r: 3.4, fill: color },
        svg(
          "title",
          {},
          `${planner}, ${over} ${x}: ${y.toFixed(1)} % [${low.toFixed(0)}, ${high.toFixed(0)}], n = ${n}`,
        ),
      ),
    );
    return [
      svg("polygon", { points: band.join(" "), fill: color, opacity: 0.1 }),
      svg("polyline", {
        points: at.map(([x, y]) => [x0(x), height(y)]).join(" "),
        fill: "none",
        stroke: color,
        "stroke-width": 2,
        "stroke-dasharray": dash,
      }),
      ...dots,
    ];
  });
  const ticks = xs.length <= 10 ? xs : xs.filter((_, k) => k % Math.ceil(xs.length / 10) === 0);
  return figure(title, [
    ...frame(
      [0, 25, 50, 75, 100].map((y) => [height(y), `${y} %`]),
      ticks.map((x) => [place(x), String(x)]),
      over,
    ),
    ...parts.flat(),
  ]);
}

/** Share of trials whose planning took no longer than x, x logarithmic. */
export function timesPanel(rows, names) {
  const all = rows.flatMap(({ seconds }) => seconds).filter((s) => s > 0);
  if (!all.length) return null;
  const [low, high] = [Math.floor(Math.log10(Math.min(...all))), Math.ceil(Math.log10(Math.max(...all)))];
  const place = (s) => scale(Math.log10(Math.max(s, 10 ** low)), low, Math.max(high, low + 1), BOX.left, W - BOX.right);
  const height = (share) => scale(share, 0, 1, H - BOX.bottom, BOX.top);
  const parts = rows.map(({ planner, seconds, n }) => {
    const { color, dash } = style(names.indexOf(planner));
    const corners = seconds.flatMap((s, k) => [
      [place(s), height(Math.max(k - 1, 0) / (seconds.length - 1))],
      [place(s), height(k / (seconds.length - 1))],
    ]);
    return svg(
      "polyline",
      { points: corners.join(" "), fill: "none", stroke: color, "stroke-width": 2, "stroke-dasharray": dash },
      svg("title", {}, `${planner}, n = ${n}`),
    );
  });
  const ticks = Array.from({ length: high - low + 1 }, (_, k) => [place(10 ** (low + k)), seconds(10 ** (low + k))]);
  return figure("", [
    ...frame(
      [0, 0.5, 1].map((y) => [height(y), `${100 * y} %`]),
      ticks,
      "planning time of a trial, at most",
    ),
    ...parts,
  ]);
}

/** Stacked counts: rows {name, total, parts: {kind: n}}. */
export function stackedBars(rows, kinds, colors) {
  return h(
    "div",
    { class: "stacks" },
    ...rows.map(({ name, total, parts }) =>
      h(
        "div",
        { class: "stack" },
        h("b", {}, name),
        h(
          "div",
          { class: "bits" },
          ...kinds
            .filter((kind) => parts[kind])
            .map((kind) =>
              h(
                "i",
                {
                  style: `flex:${parts[kind]};background:${colors[kinds.indexOf(kind) % colors.length]}`,
                  title: `${kind}: ${parts[kind]} of ${total}`,
                },
                parts[kind] / total > 0.04 ? String(parts[kind]) : "",
              ),
            ),
          h("i", { class: "rest", style: `flex:${total - kinds.reduce((sum, kind) => sum + (parts[kind] ?? 0), 0)}` }),
        ),
      ),
    ),
    h(
      "p",
      { class: "legend" },
      ...kinds.map((kind, k) =>
        h("span", {}, h("i", { class: "key", style: `background:${colors[k % colors.length]}` }), kind),
      ),
    ),
  );
}

function figure(title, parts) {
  return h(
    "figure",
    {},
    title ? h("figcaption", {}, title) : null,
    svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img" }, ...parts),
  );
}

function frame(ys, xs, label) {
  return [
    ...ys.map(([y, text]) =>
      svg(
        "g",
        {},
        svg("line", { x1: BOX.left, x2: W - BOX.right, y1: y, y2: y, class: "grid" }),
        svg("text", { x: BOX.left - 6, y: y + 4, "text-anchor": "end" }, text),
      ),
    ),
    ...xs.map(([x, text]) => svg("text", { x, y: H - BOX.bottom + 15, "text-anchor": "middle" }, text)),
    svg("text", { x: (W + BOX.left) / 2, y: H - 4, "text-anchor": "middle", class: "axislabel" }, label),
  ];
}

export function seconds(s) {
  if (s < 1e-3) return `${+(s * 1e6).toPrecision(2)} µs`;
  return s < 1 ? `${+(s * 1e3).toPrecision(2)} ms` : `${+s.toPrecision(2)} s`;
}

function scale(value, low, high, from, to) {
  return high > low ? from + ((value - low) / (high - low)) * (to - from) : (from + to) / 2;
}
