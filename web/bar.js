// What happened when, a row per planner: still or moving, solves, violations, arrival; a click seeks.

import { h, svg } from "./dom.js";
import { VERDICTS } from "./look.js";

const WIDTH = 1000;
const HEIGHT = 34;

export function bar(trial, clock) {
  const x = (time) => (WIDTH * time) / Math.max(clock.end, 1e-9);
  const span = (from, to, attributes) =>
    svg("rect", { x: x(from), width: Math.max(x(to) - x(from), 0.5), ...attributes });
  const title = (text) => svg("title", {}, text);
  const parts = [span(0, trial.end, { y: 12, height: 10, class: "moving" })];
  for (const [from, to] of trial.holds) parts.push(span(from, to, { y: 12, height: 10, class: "holding" }));
  trial.looks?.solves.forEach((time, k) => {
    const found = trial.looks.lengths[k] > 0;
    const text = `solve at ${time} s: ${trial.looks.statuses[k]}`;
    parts.push(
      svg(
        "rect",
        { x: x(time) - 1, y: found ? 25 : 24, width: 2, height: found ? 5 : 9, class: found ? "solve" : "nopath" },
        title(text),
      ),
    );
  });
  const last = {};
  for (const name of Object.keys(VERDICTS).reverse()) {
    const { success, time, kind } = trial.verdicts[name];
    if (success || time === null) continue;
    last[time] = [...(last[time] ?? []), `${VERDICTS[name]}: ${kind} at ${time.toFixed(2)} s`];
    parts.push(
      svg("path", { d: `M${x(time) - 6},0h12l-6,11z`, class: `violation ${name}` }, title(last[time].join("\n"))),
    );
  }
  if (trial.arrival !== null)
    parts.push(
      svg(
        "circle",
        { cx: x(trial.arrival), cy: 17, r: 5, class: "arrival" },
        title(`at the goal at ${trial.arrival.toFixed(2)} s`),
      ),
    );
  const head = svg("line", { y1: 0, y2: HEIGHT, class: "head", "vector-effect": "non-scaling-stroke" });
  clock.listen((time) => {
    head.setAttribute("x1", x(time));
    head.setAttribute("x2", x(time));
  });
  const picture = svg(
    "svg",
    { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", class: "bar" },
    ...parts,
    head,
  );
  const seek = (event) => {
    if (event.buttons !== 1 && event.type !== "click") return;
    const { left, width } = picture.getBoundingClientRect();
    clock.seek(((event.clientX - left) / width) * clock.end);
  };
  picture.addEventListener("click", seek);
  picture.addEventListener("pointermove", seek);
  return picture;
}

// A label at either end stays within the axis.
const place = (share) => `left:${100 * share}%;transform:translateX(${-100 * share}%)`;

/** The times below the bars: some whole numbers of seconds. */
export function axis(clock) {
  const step = [0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find((each) => clock.end / each <= 8) ?? 1200;
  const marks = Array.from({ length: Math.floor(clock.end / step + 1e-9) + 1 }, (_, k) => k * step);
  return h(
    "div",
    { class: "axis" },
    ...marks.map((time) => h("span", { style: place(time / Math.max(clock.end, 1e-9)) }, `${time} s`)),
  );
}
