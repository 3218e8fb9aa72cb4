// A table that sorts by the column whose head is pressed; cells {text, sort} or elements.

import { h } from "./dom.js";

/** Columns {title, hint, cell(row) -> text or element, sort(row) -> number or text, left}. */
export function sortable(columns, rows, { limit = Infinity, className = "" } = {}) {
  let [by, down, shown] = [null, false, limit];
  const body = h("tbody");
  const more = h("button", { onclick: () => fill((shown += 5 * limit)) });
  const heads = columns.map((column, k) => {
    const press = () => {
      down = by === k ? !down : false;
      by = k;
      fill();
    };
    return h(
      "th",
      { class: column.left ? "left" : "", scope: "col" },
      h("button", { onclick: press, title: column.hint }, column.title),
    );
  });
  const order = () => {
    if (by === null) return rows;
    const value = columns[by].sort;
    const sign = down ? -1 : 1;
    return rows.toSorted((a, b) => {
      const [x, y] = [value(a), value(b)];
      if (x === null || y === null) return (x === null) - (y === null); // what there is not comes last either way
      return sign * (x < y ? -1 : x > y ? 1 : 0);
    });
  };
  const fill = () => {
    heads.forEach((head, k) => head.setAttribute("aria-sort", by === k ? (down ? "descending" : "ascending") : "none"));
    body.replaceChildren(
      ...order()
        .slice(0, shown)
        .map((row) =>
          h("tr", {}, ...columns.map((column) => h("td", { class: column.left ? "left" : "" }, column.cell(row)))),
        ),
    );
    more.textContent = `${rows.length - shown} more`;
    more.hidden = rows.length <= shown;
  };
  fill();
  const element = h(
    "div",
    { class: `table ${className}` },
    h("table", {}, h("thead", {}, h("tr", {}, ...heads)), body),
    more,
  );
  return {
    element,
    set(next) {
      rows = next;
      shown = limit;
      fill();
    },
  };
}
