// The replay: viewports, clock, bars, words.

import { axis, bar } from "./bar.js";
import { Clock } from "./clock.js";
import { h } from "./dom.js";
import { backbone, decodeScenario, decodeTrial } from "./episode.js";
import { VERDICTS } from "./look.js";
import { Stage } from "./stage.js";
import { View } from "./view.js";

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10];
const KEYS =
  "Space plays, ← → step 0.1 s (with Shift 1 s), Home and End, , and . change speed, V jumps to the next violation, C puts the camera back.";

/** Show `data` inside `place`; resolves when the first picture is drawn. Returns what ends it. */
export async function play(place, data) {
  const scenario = await decodeScenario(data.scenario);
  const trials = await Promise.all(data.trials.map((trial) => decodeTrial(trial, scenario)));
  const clock = new Clock(data.end, data.open);
  const views = (trials.length ? trials : [null]).map((trial) => new View(scenario, trial));
  const stage = new Stage(views, surroundings(scenario, trials), interesting(scenario, trials, clock));
  const panels = views.map((view) => panel(view.trial));
  const grid = h("div", { class: `panels of${panels.length}` }, ...panels.map(({ box }) => box));
  const screen = h("div", { class: "screen" }, stage.canvas, grid);
  const { element: controls, update: updateControls } = controlBar(clock, stage, trials);
  const root = h(
    "section",
    { class: "replay", tabindex: "0", "aria-label": "replay" },
    h("header", {}, h("h2", {}, data.scenario.id), h("span", { class: "run" }, data.run)),
    screen,
    controls,
    h(
      "div",
      { class: "bars" },
      ...trials.map((trial) => h("div", { class: "row" }, h("b", {}, trial.planner), bar(trial, clock))),
      trials.length ? h("div", { class: "row" }, h("b"), axis(clock)) : null,
    ),
    trials.length ? barLegend(trials) : null,
    h("div", { class: "stories" }, ...trials.map(story)),
    legend(trials),
    h("p", { class: "keys" }, KEYS),
  );
  place.replaceChildren(root);
  clock.listen((time) => {
    views.forEach((view, k) => panels[k].say(time, view.show(time)));
    stage.render();
    updateControls();
  });
  const lay = () => {
    const outer = screen.getBoundingClientRect();
    const boxes = panels.map(({ box }) => {
      const { left, top, width, height } = box.getBoundingClientRect();
      return { left: left - outer.left, top: top - outer.top, width, height };
    });
    stage.lay(outer.width, outer.height, boxes);
  };
  const observer = new ResizeObserver(lay);
  observer.observe(screen);
  const onKey = (event) => key(event, clock, stage, trials);
  document.addEventListener("keydown", onKey);
  lay();
  clock.seek(data.open);
  root.dataset.ready = "true";
  Object.assign(root, { clock, views, stage }); // for whoever looks at the page from the console, and for tests
  return {
    clock,
    end() {
      clock.playing = false;
      observer.disconnect();
      document.removeEventListener("keydown", onKey);
      stage.renderer.dispose();
      stage.renderer.forceContextLoss();
      place.replaceChildren();
    },
  };
}

/** Where the camera had better look from: the side of what is touched, or of the goal. */
function interesting(scenario, trials, clock) {
  const touching = trials.find((trial) => trial.contact);
  if (!touching) return scenario.goal;
  return scenario.centers(touching.verdicts.swept.time ?? clock.time)[touching.contact[0] - 1];
}

/** A sphere about arms, goal, and obstacles where the arms may reach them. */
function surroundings(scenario, trials) {
  const reach = scenario.arm.n_sections * scenario.arm.section_length_m;
  const points = [[0, 0, 0], scenario.goal];
  const end = Math.max(...trials.map((trial) => trial.end), 10);
  for (let k = 0; k <= 12; k++) {
    const time = (end * k) / 12;
    const states = trials.length ? trials.map((trial) => trial.state(time)) : [scenario.start];
    for (const state of states) points.push(...backbone(state, scenario.arm, 3).map(({ p }) => p));
    points.push(...scenario.centers(time).filter((p) => Math.hypot(...p) < 1.1 * reach));
  }
  const center = [0, 1, 2].map(
    (i) => (Math.min(...points.map((p) => p[i])) + Math.max(...points.map((p) => p[i]))) / 2,
  );
  const radius =
    Math.max(...points.map((p) => Math.hypot(...p.map((x, i) => x - center[i])))) + 2 * scenario.arm.radius_m;
  return { center, radius };
}

function panel(trial) {
  const readout = h("p", { class: "readout" });
  const chip = trial && h("span", { class: `chip ${trial.outcome}` }, trial.outcome.replace("_", " "));
  const box = h(
    "div",
    { class: "panel" },
    trial && h("h3", {}, trial.planner, " ", chip),
    trial && verdicts(trial),
    readout,
  );
  const say = (time, { near, expected, touched }) => {
    const parts = [];
    if (trial && time > trial.end + 1e-6) parts.push(`ended at ${trial.end.toFixed(1)} s`);
    else if (trial) parts.push(trial.holds.some(([from, to]) => time >= from && time < to) ? "holding" : "moving");
    const { time: first, kind } = trial?.verdicts.swept ?? {};
    if (kind === "collision" && time > first && !touched) parts.push(`touched at ${first.toFixed(2)} s`);
    if (near && near.obstacle >= 0) {
      const millimetres = 1000 * near.metres;
      parts.push(
        touched || millimetres <= 0
          ? `obstacle ${near.obstacle + 1} at section ${near.section}: contact`
          : `nearest: obstacle ${near.obstacle + 1} to section ${near.section}, ${millimetres.toFixed(1)} mm`,
      );
    }
    if (expected) parts.push(`looked at ${expected.looked.toFixed(0)} s`);
    readout.textContent = parts.join(" · ");
    box.classList.toggle("touched", touched);
  };
  return { box, say };
}

function verdicts(trial) {
  const said = (name) =>
    h(
      "span",
      { class: trial.verdicts[name].success ? "good" : "bad" },
      `${trial.verdicts[name].success ? "✓" : "✗"} ${VERDICTS[name]}`,
    );
  return h("p", { class: "verdicts" }, ...Object.keys(VERDICTS).map(said));
}

function controlBar(clock, stage, trials) {
  const button = h("button", { class: "play", onclick: () => clock.toggle() }, "Play");
  const slider = h("input", {
    type: "range",
    min: 0,
    max: clock.end,
    step: 0.01,
    "aria-label": "time",
    oninput: () => clock.seek(Number(slider.value)),
  });
  const shown = h("output", { class: "time" });
  const speed = h(
    "select",
    { "aria-label": "speed", onchange: () => (clock.speed = Number(speed.value)) },
    ...SPEEDS.map((value) => h("option", { value, selected: value === clock.speed }, `${value}×`)),
  );
  const jump = h("button", { onclick: () => nextViolation(clock, trials), title: "key V" }, "Next violation");
  const home = h("button", { onclick: () => stage.goHome(), title: "key C" }, "Camera");
  const element = h("div", { class: "controls" }, button, shown, slider, speed, trials.length ? jump : null, home);
  const update = () => {
    button.textContent = clock.playing ? "Pause" : "Play";
    slider.value = clock.time;
    shown.textContent = `${clock.time.toFixed(2)} s`;
    speed.value = clock.speed;
  };
  return { element, update };
}

function nextViolation(clock, trials) {
  const times = trials
    .flatMap((trial) => Object.keys(VERDICTS).map((name) => trial.verdicts[name].time))
    .filter((time) => time !== null);
  const later = times.filter((time) => time > clock.time + 1e-6);
  const wanted = later.length ? later : times;
  if (wanted.length) clock.seek(Math.min(...wanted));
}

function key(event, clock, stage, trials) {
  if (
    event.target.closest("input:not([type=range]), select, textarea") ||
    event.ctrlKey ||
    event.metaKey ||
    event.altKey
  )
    return;
  const step = event.shiftKey ? 1 : 0.1;
  const faster = (by) => {
    const at = SPEEDS.indexOf(clock.speed) + by;
    clock.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    clock.tell();
  };
  const actions = {
    " ": () => clock.toggle(),
    ArrowLeft: () => clock.seek(clock.time - step),
    ArrowRight: () => clock.seek(clock.time + step),
    Home: () => clock.seek(0),
    End: () => clock.seek(clock.end),
    ",": () => faster(-1),
    ".": () => faster(1),
    v: () => nextViolation(clock, trials),
    c: () => stage.goHome(),
  };
  const action = actions[event.key] ?? actions[event.key.toLowerCase()];
  if (!action || (event.key === " " && event.target.closest("button, a"))) return;
  event.preventDefault();
  action();
}

function story(trial) {
  return h(
    "article",
    {},
    h("h3", {}, trial.planner),
    h("p", {}, trial.story.join(" ") || "Nothing to tell."),
    trial.remark ? h("p", { class: "remark" }, trial.remark) : null,
  );
}

function barLegend(trials) {
  const items = [
    ["moving", "moving"],
    ["holding", "holding"],
    ["violation swept", "first violation of a verdict"],
    ["arrival", "at the goal"],
  ];
  if (trials.some((trial) => trial.looks)) items.splice(2, 0, ["solve", "solve"], ["nopath", "solve without a path"]);
  return h(
    "p",
    { class: "legend" },
    ...items.map(([name, text]) => h("span", {}, h("i", { class: `key ${name}` }), text)),
  );
}

function legend(trials) {
  const items = [
    ["obstacle", "obstacle, and where it has been"],
    ["goal", "goal with its tolerance"],
  ];
  if (trials.length) items.push(["trail", "way of the tip"]);
  if (trials.some((trial) => trial.looks))
    items.push(
      ["expected", "where the planner expects obstacles, grown by its margin, and from here on"],
      ["path", "its path still ahead (tip)"],
    );
  return h(
    "p",
    { class: "legend" },
    ...items.map(([name, text]) => h("span", {}, h("i", { class: `key ${name}` }), text)),
  );
}
