// Tables: sort by a column, filter by words, save as CSV, follow a row to its images.

import { axisOf, model, rowOf, table } from "report/data";
import { choice, download, h, number, redraw, select, unseen } from "report/dom";
import { isNumber, parseFilter, value } from "report/filter";
import { go, keep, state as current } from "report/state";

const FILES = [["errors.csv", "Errors"], ["errors_by_n_dot_v.csv", "Errors by n·v"], ["timings.csv", "Timings"]];
/** Rows put on the page at once; a button adds as many again. */
const PAGE_ROWS = 200;

/** The page of tables. */
export function showTables(view, state) {
  const files = FILES.filter(([name]) => model.runs.some((_, run) => table(run, name)));
  const file = files.find(([name]) => name === state.table)?.[0] ?? files[0][0];
  const run = Number(state.run) || 0, own = table(run, file);
  const bar = h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Tables"));
  if (!own) return view.replaceChildren(bar, h("p", { class: "note" }, `This run has no ${file}.`));
  const { columns, rows, text } = own;
  const isIdle = (name, i) => name === "cell" || ((axisOf[name] || name === "diffuse_weight" || name === "device") && new Set(rows.map((row) => row[i]).filter(Boolean)).size < 2);
  const all = state.columns === "all";
  const shown = columns.map((name, i) => [name, i]).filter(([name, i]) => all || !isIdle(name, i));
  let sort = columns.includes(state.sort?.replace(/^-/, "")) ? state.sort : "", filter = state.filter ?? "", limit = PAGE_ROWS;
  // What was filtered and sorted since the page was made stands in the address alone.
  const again = (details) => { keep(details); redraw(view, () => showTables(view, current())); };

  const body = h("tbody", {}), count = h("p", { class: "note", "aria-live": "polite" }), complaint = h("p", { class: "complaint", role: "status", id: "filter-complaint" }), more = h("button", { type: "button", onclick: () => { limit += PAGE_ROWS; fill(); } }, "Show more rows");
  const heads = shown.map(([name, i]) => {
    const metric = model.metrics.find((one) => one.name === name);
    return h("th", { scope: "col", title: metric?.formula }, h("button", { type: "button", "data-sort": name, onclick: () => {
      sort = sort === name ? `-${name}` : sort === `-${name}` ? "" : name;
      keep({ sort });
      fill();
    } }, name, h("span", { "aria-hidden": "true", class: "arrow" })));
  });
  const fill = () => {
    const name = sort.replace(/^-/, ""), place = columns.indexOf(name), sign = sort.startsWith("-") ? -1 : 1;
    const { test, complaints } = parseFilter(columns, filter), found = rows.filter(test);
    complaint.textContent = complaints.length ? `Not understood: ${complaints.join("; ")}. Columns are listed in the head of the table${all ? "" : ", more of them under “all columns”"}.` : "";
    box.setAttribute("aria-invalid", String(complaints.length > 0));
    if (place >= 0) {
      found.sort(([...a], [...b]) => {
        const [x, y] = [a[place], b[place]];
        if (x === "" || y === "") return x === y ? 0 : x === "" ? 1 : -1;
        return sign * (isNumber(x) && isNumber(y) ? value(x) - value(y) : x < y ? -1 : x > y ? 1 : 0);
      });
    }
    heads.forEach((head, i) => head.setAttribute("aria-sort", shown[i][0] !== name ? "none" : sign > 0 ? "ascending" : "descending"));
    const cell = columns.indexOf("cell");
    body.replaceChildren(...found.slice(0, limit).map((row) => {
      const target = rowOf(row[cell], run);
      return h("tr", { class: target?.image != null ? "open" : "", onclick: (event) => { if (target && !event.target.closest("button")) openRow(target); } },
        h("td", {}, target?.image != null && h("button", { type: "button", "aria-label": `Compare ${row[cell]}`, onclick: () => openRow(target) }, "▸")),
        shown.map(([, i]) => h("td", { class: isNumber(row[i]) ? "number" : "", title: row[i] }, isNumber(row[i]) && row[i].length > 8 ? number(value(row[i]), 4) : row[i])));
    }));
    count.textContent = `${found.length} of ${rows.length} rows${found.length > limit ? `; the first ${limit} are shown` : ""}`;
    more.hidden = found.length <= limit;
  };
  const box = h("input", { type: "search", value: filter, size: 28, "aria-describedby": "filter-complaint", placeholder: "words, alpha = 0.1, brdf != ggx", oninput: () => { filter = box.value; limit = PAGE_ROWS; keep({ filter }); fill(); } });
  bar.append(
    choice("Table", files, file, (name) => again({ table: name, sort: "", filter: "" })),
    model.runs.length > 1 ? select("Run", model.runs.map((one, i) => [i, one.label]), run, (value) => again({ run: value })) : "",
    h("label", { class: "choice" }, h("span", {}, "Filter"), box),
    h("label", { class: "check" }, h("input", { type: "checkbox", checked: all, onchange: (event) => again({ columns: event.target.checked ? "all" : "" }) }), " all columns"),
    h("button", { type: "button", onclick: () => download(file, text, "text/csv") }, `Save ${file}`));
  fill();
  view.replaceChildren(bar, complaint, count, h("div", { class: "scroll data-table", tabindex: 0, role: "region", "aria-label": file }, h("table", {}, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, unseen("images")), heads)), body)), more);
  return undefined;
}

const openRow = (row) => go({ view: "compare", cell: row.cell, run: row.run || undefined });
