// The report: headline, table, charts, pairs, and the list of trials with their replays.

import { curvePanel, key, seconds, stackedBars, timesPanel } from "./charts.js";
import { h } from "./dom.js";
import { VERDICTS } from "./look.js";
import { openReplay } from "./replay_dialog.js";
import { sortable } from "./table.js";
import { trialList } from "./trials.js";

const KIND_COLORS = ["#D55E00", "#E69F00", "#56B4E9", "#CC79A7", "#0072B2", "#009E73", "#8C6D31", "#444444"];

export async function report(place, data) {
  const parts = {
    headline: h("p", { class: "headline" }),
    table: h("div"),
    curves: h("div", { class: "charts" }),
    failures: h("div"),
    pairs: h("div"),
  };
  const trials = trialList(data, (row) => openReplay(data, row));
  const sections = [
    [
      "Table",
      h("p", { class: "soft" }, data.conditions),
      parts.table,
      h("details", {}, h("summary", {}, "How to read it"), h("p", {}, data.notes)),
    ],
    ["Success over conditions", data.curves.length ? key(data.planners) : null, parts.curves],
    [
      "Planning times",
      h("p", { class: "soft" }, "Share of all trials, failures too, whose solves took no longer in all."),
      key(data.planners),
      h("div", { class: "charts" }, timesPanel(data.times, data.planners)),
    ],
    ["Why trials fail", parts.failures],
    ["In pairs, on the same scenarios", parts.pairs],
    ["Trials", trials.element],
  ];
  const pick = h(
    "div",
    { class: "verdict", role: "radiogroup", "aria-label": "verdict" },
    "Success: ",
    ...Object.entries(VERDICTS).map(([name, text]) =>
      h(
        "label",
        {},
        h("input", {
          type: "radio",
          name: "verdict",
          value: name,
          checked: name === "swept",
          onchange: () => show(name),
        }),
        text,
      ),
    ),
  );
  const show = (verdict) => {
    parts.headline.textContent = data.headlines[verdict];
    parts.table.replaceChildren(mainTable(data, verdict));
    parts.curves.replaceChildren(
      ...data.curves.flatMap(({ over, panels }) =>
        (panels[verdict] ?? []).slice(0, 12).map(({ title, lines }) => curvePanel(title, over, lines, data.planners)),
      ),
    );
    parts.failures.replaceChildren(...failureParts(data, verdict));
    parts.pairs.replaceChildren(pairTable(data, verdict));
    trials.judge(verdict);
  };
  place.replaceChildren(
    h(
      "section",
      { class: "report" },
      h("h1", {}, data.run),
      parts.headline,
      pick,
      ...sections
        .filter(([, ...content]) => content.some(Boolean))
        .map(([title, ...content]) => h("section", {}, h("h2", {}, title), ...content)),
    ),
  );
  show("swept");
  place.firstChild.dataset.ready = "true";
}

function mainTable(data, verdict) {
  const { entries } = data;
  const number = (title, name, hint, text = (value) => +value.toPrecision(3)) => ({
    title,
    hint,
    sort: (row) => row[name],
    cell: (row) => (row[name] === null ? "-" : String(text(row[name]))),
  });
  const columns = [
    { title: "conditions", left: true, sort: (row) => row.place, cell: (row) => row.place },
    {
      title: "planner",
      left: true,
      sort: (row) => row.label,
      cell: (row) => (row.bound ? `${row.label} (bound)` : row.label),
    },
    number("n", "n", "trials"),
    {
      title: `${VERDICTS[verdict]} %`,
      hint: "successes in percent of all trials, with the 95 % Wilson interval",
      sort: (row) => row.success[verdict][0],
      cell: (row) => success(row.success[verdict]),
    },
    ...(entries.some((row) => row.bound)
      ? [
          {
            title: "possible / open / impossible",
            hint: "of the planner's scenarios: solved by somebody, neither, proven impossible; for the executable verdict",
            sort: (row) => row.scenarios[0],
            cell: (row) => (row.scenarios[0] === null ? "-" : row.scenarios.join(" / ")),
          },
        ]
      : []), // without a bound nobody has asked
    number("planning, mean", "planning_mean", "sum over a trial's solves", seconds),
    number("median", "planning_median", "sum over a trial's solves", seconds),
    number("solve", "solve", "median of the trials' median solves", seconds),
    number("arrival s", "arrival", "median over trials that reached the goal"),
    number("tip path m", "tip_path", "median over trials that reached the goal"),
    number("S rad", "smoothness", "the paper's smoothness, median over trials that reached the goal"),
    ...(entries.some((row) => row.errors)
      ? [number("errors", "errors", "trials in which the planner failed as a program")]
      : []),
    ...(entries.some((row) => row.stale)
      ? [number("stale", "stale", "trials run by other code than the present")]
      : []),
  ];
  return sortable(columns, entries, { limit: 200, className: "main" }).element;
}

function success([percent, low, high]) {
  if (percent === null) return "-";
  const bar = h(
    "span",
    { class: "meter", "aria-hidden": "true" },
    h("i", { style: `left:${low}%;width:${high - low}%` }),
    h("b", { style: `left:${percent}%` }),
  );
  return h("span", { class: "success" }, `${percent.toFixed(0)} [${low.toFixed(0)}, ${high.toFixed(0)}]`, bar);
}

function failureParts(data, verdict) {
  const rows = (of) => data.failures.map((each) => ({ name: each.planner, total: each.n, parts: of(each) }));
  const kindsOf = (list) => [...new Set(list.flatMap(({ parts }) => Object.keys(parts)))];
  const kinds = rows((each) => each.kinds[verdict]);
  const touched = rows((each) => each.touched);
  return [
    h("h3", {}, `First violation (${VERDICTS[verdict]}), of all trials`),
    stackedBars(kinds, kindsOf(kinds), KIND_COLORS),
    ...(kindsOf(touched).length
      ? [
          h("h3", {}, "What touched an obstacle first, at any instant, of all trials"),
          stackedBars(touched, kindsOf(touched).sort(), KIND_COLORS),
        ]
      : []),
  ];
}

function pairTable(data, verdict) {
  const rows = data.pairs[verdict];
  if (!rows.length)
    return h("p", { class: "soft" }, "Not shown: pairs are tested where two to twelve planners compete.");
  const select = h(
    "select",
    { "aria-label": "reference", onchange: () => table.set(of(select.value)) },
    ...[...new Set(rows.map((row) => row.reference))].map((name) => h("option", { value: name }, name)),
  );
  const of = (name) => rows.filter((row) => row.reference === name);
  const table = sortable(
    [
      { title: "conditions", left: true, sort: (row) => row.place, cell: (row) => row.place },
      { title: "planner", left: true, sort: (row) => row.planner, cell: (row) => row.planner },
      {
        title: "scenarios",
        hint: "that both were tried on",
        sort: (row) => row.scenarios,
        cell: (row) => String(row.scenarios),
      },
      {
        title: "only planner",
        hint: "scenarios that it alone solved",
        sort: (row) => row.only[0],
        cell: (row) => String(row.only[0]),
      },
      {
        title: "only reference",
        hint: "scenarios that the reference alone solved",
        sort: (row) => row.only[1],
        cell: (row) => String(row.only[1]),
      },
      {
        title: "p, Holm",
        hint: "two-sided exact McNemar test, corrected for the pairs with this reference",
        sort: (row) => row.p,
        cell: (row) => String(+row.p.toPrecision(2)),
      },
    ],
    of(rows[0].reference),
    { limit: 100 },
  );
  return h("div", {}, h("p", {}, "against ", select), table.element);
}
