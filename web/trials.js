// The list of trials: filters by outcome, planner, conditions and disagreement; a row opens its replay.

import { seconds } from "./charts.js";
import { h } from "./dom.js";
import { sortable } from "./table.js";

export function trialList(data, open) {
  const rows = data.trials.scenario_id.map((_, k) =>
    Object.fromEntries(Object.entries(data.trials).map(([name, column]) => [name, column[k]])),
  );
  for (const row of rows)
    Object.assign(row, {
      place_in_scenario: row.place,
      place: data.entries[row.entry].place,
      label: data.entries[row.entry].label,
    });
  let verdict = "swept";
  const choice = (label, values) =>
    h(
      "label",
      {},
      `${label} `,
      h(
        "select",
        { onchange: () => refresh() },
        h("option", { value: "" }, "all"),
        ...values.map((value) => h("option", { value }, value)),
      ),
    );
  const unique = (name) => [...new Set(rows.map((row) => row[name]))];
  const filters = {
    place: choice("conditions", unique("place")),
    label: choice("planner", unique("label")),
    outcome: choice("outcome", unique("outcome").sort()),
    judged: choice("verdict", ["success", "failure"]),
  };
  const disagreed = h("input", { type: "checkbox", onchange: () => refresh() });
  const count = h("p", { class: "soft count", role: "status" });
  const table = sortable(
    columns(() => verdict, data, open),
    rows,
    { limit: 100, className: "trials" },
  );
  const refresh = () => {
    const wanted = Object.entries(filters).map(([name, label]) => [name, label.querySelector("select").value]);
    const kept = rows.filter(
      (row) =>
        wanted.every(
          ([name, value]) =>
            !value || (name === "judged" ? (row[`success_${verdict}`] ? "success" : "failure") : row[name]) === value,
        ) &&
        (!disagreed.checked || row.disagreed),
    );
    count.textContent = `${kept.length} of ${rows.length} trials${rows.length < data.count ? ` (of ${data.count} in the run, those on which planners disagree first)` : ""}`;
    table.set(kept);
  };
  refresh();
  const without = Object.keys(data.episodes).length
    ? null
    : h(
        "p",
        { class: "soft" },
        `No motions stand in this page: suite show ${data.run} --scenario ID plays trials again.`,
      );
  const element = h(
    "div",
    {},
    without,
    h("div", { class: "filters" }, ...Object.values(filters), h("label", {}, disagreed, " planners disagree (swept)")),
    count,
    table.element,
  );
  return {
    element,
    judge(name) {
      verdict = name;
      refresh();
    },
  };
}

function columns(verdict, data, open) {
  const kind = (row) => row[`violation_${verdict()}_kind`];
  return [
    {
      title: "scenario",
      left: true,
      sort: (row) => row.scenario_id,
      cell: (row) =>
        data.episodes[row.scenario_id]
          ? h("button", { class: "link", onclick: () => open(row), title: "replay" }, row.scenario_id)
          : row.scenario_id,
    },
    { title: "conditions", left: true, sort: (row) => row.place, cell: (row) => row.place },
    { title: "planner", left: true, sort: (row) => row.label, cell: (row) => row.label },
    {
      title: "success",
      left: true,
      sort: (row) => Number(Boolean(row[`success_${verdict()}`])),
      cell: (row) =>
        h("span", { class: row[`success_${verdict()}`] ? "good" : "bad" }, row[`success_${verdict()}`] ? "✓" : "✗"),
    },
    {
      title: "outcome",
      left: true,
      sort: (row) => row.outcome,
      cell: (row) => h("span", { class: `chip ${row.outcome}` }, row.outcome.replace("_", " ")),
    },
    {
      title: "first violation",
      left: true,
      sort: kind,
      cell: (row) => (kind(row) ? `${kind(row)} at ${row[`violation_${verdict()}_time_s`]} s` : ""),
    },
    {
      title: "touched",
      left: true,
      sort: (row) => row.contact_section,
      cell: (row) =>
        row.contact_section
          ? `obstacle ${row.contact_obstacle}, section ${row.contact_section}, arm ${row.contact_while}`
          : "",
    },
    {
      title: "planning",
      sort: (row) => row.planning_time_s,
      cell: (row) => (row.planning_time_s === null ? "-" : seconds(row.planning_time_s)),
    },
  ];
}
