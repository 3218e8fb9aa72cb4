// A trial's replay over the report: the trial that was asked for first, beside the others on its scenario.

import { h } from "./dom.js";
import { play } from "./player.js";

const BEFORE = 2;
const SIDE_BY_SIDE = 4;

export async function openReplay(data, row) {
  const episode = data.episodes[row.scenario_id];
  const order = [row.place_in_scenario, ...episode.trials.keys()].filter((k, at, all) => all.indexOf(k) === at);
  const won = (k) => episode.trials[k].verdicts.swept.success;
  const beside = order.find((k) => won(k) !== won(order[0])) ?? order[1]; // one that fared otherwise says most
  const chosen = new Set([order[0], beside].filter((k) => k !== undefined));
  const place = h("div");
  let player = null;
  const show = async () => {
    player?.end();
    const trials = order.filter((k) => chosen.has(k)).map((k) => episode.trials[k]);
    const touched = trials
      .map(({ verdicts }) => verdicts.swept)
      .filter(({ kind }) => kind === "collision")
      .map(({ time }) => time);
    player = await play(place, {
      ...episode,
      kind: "replay",
      run: data.run,
      trials,
      open: touched.length ? Math.max(0, Math.min(...touched) - BEFORE) : 0,
    });
  };
  const toggle = (k) => {
    if (chosen.has(k) && chosen.size > 1) chosen.delete(k);
    else if (chosen.size < SIDE_BY_SIDE) chosen.add(k);
    boxes.forEach(([at, box]) => (box.checked = chosen.has(at)));
    show();
  };
  const boxes = order.map((k) => [
    k,
    h("input", { type: "checkbox", checked: chosen.has(k), onchange: () => toggle(k) }),
  ]);
  const command = `suite show ${data.run} --scenario ${row.scenario_id}`;
  const dialog = h(
    "dialog",
    { class: "over", "aria-label": `replay of ${row.scenario_id}` },
    h(
      "div",
      { class: "bar" },
      h("span", { class: "who" }, ...boxes.map(([k, box]) => h("label", {}, box, " ", episode.trials[k].planner))),
      h("button", { class: "close", onclick: () => dialog.close() }, "Close"),
    ),
    place,
    h("p", { class: "soft" }, "What planners believed, and their paths, are shown by ", h("code", {}, command), "."),
  );
  dialog.addEventListener("close", () => {
    player?.end();
    dialog.remove();
  });
  document.body.append(dialog);
  dialog.showModal();
  await show();
}
