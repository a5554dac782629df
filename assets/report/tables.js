// Tables: the cells of the run, by a choice for each swept axis, sorted by a column.

import { axisOf, model, rows, short } from "report/data";
import { csvText, download, h, number, scrollBox, select, tableHead } from "report/dom";
import { go, keep } from "report/state";

/** Rows shown at first; a button adds as many again. */
const PAGE_ROWS = 200;
const ROUGHNESS = "perceptual_roughness";

/** The text of a field: numbers short. */
const text = (field) =>
  typeof field === "number" && !Number.isInteger(field) ? number(field, 4) : String(field ?? "");
/** A cell of a table; its text may be shortened, its title is complete. */
const cellOf = (field, shown = text(field)) =>
  h("td", { class: typeof field === "number" ? "number" : "", title: field ?? "" }, shown);

/** A table of rows as they are, in a box that scrolls. */
export function dataTable(label, columns, rows) {
  const body = rows.map((row) => h("tr", {}, ...row.map((field) => cellOf(field))));
  return scrollBox("data-table", label, h("table", {}, tableHead(columns), h("tbody", {}, ...body)));
}

/** Orders fields: numbers by size, texts by letters, nothing last. */
function order(a, b) {
  const isNothing = (x) => x === null || x === "";
  if (isNothing(a) || isNothing(b)) return Number(isNothing(a)) - Number(isNothing(b));
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? String(a).localeCompare(String(b)) : x - y;
}

/** Columns of the table of cells: swept axes, the roughness of alpha, scores. */
function cellColumns() {
  const isSwept = (name) => name !== "run" && axisOf[name]?.values.length > 1;
  const axes = model.columns.filter(isSwept);
  const at = axes.indexOf("alpha") + 1;
  if (at > 0 && !axes.includes(ROUGHNESS)) axes.splice(at, 0, ROUGHNESS);
  const scores = model.metrics.map((metric) => metric.name);
  const columns = [...(model.runs.length > 1 ? ["run"] : []), ...axes, ...scores, "noise_floor", "verdict", "cell"];
  const numeric = (value) => (value !== "" && Number.isFinite(Number(value)) ? Number(value) : value);
  const fields = (row) => ({
    ...Object.fromEntries(Object.entries(row.axes).map(([name, value]) => [name, numeric(value)])),
    [ROUGHNESS]: Number(row.axes[ROUGHNESS] || Math.sqrt(Number(row.axes.alpha))) || null,
    ...{ ...row.scores, noise_floor: row.floor, verdict: row.verdict, cell: row.cell },
  });
  const records = rows.map((row) => ({ row, fields: fields(row) }));
  return { columns, axes: axes.filter((name) => axisOf[name]), records };
}

const open = (row) => go({ view: "compare", cell: row.cell, run: row.run || undefined });

/** The page of tables. */
export function showTables(view, state) {
  const { columns, axes, records } = cellColumns();
  const chosen = (name) => (axisOf[name].values.includes(state[name]) ? state[name] : "");
  const filters = Object.fromEntries(axes.map((name) => [name, chosen(name)]));
  let sort = columns.includes(state.sort?.replace(/^-/, "")) ? state.sort : "";
  let limit = PAGE_ROWS;
  const body = h("tbody", {});
  const count = h("p", { class: "note", "aria-live": "polite" });
  const more = h("button", { type: "button", onclick: () => fill(limit + PAGE_ROWS) }, "Show more rows");
  const press = (name) => {
    sort = sort === name ? `-${name}` : sort === `-${name}` ? "" : name;
    keep({ sort });
    fill(PAGE_ROWS);
  };
  const formulaOf = (name) => model.metrics.find((one) => one.name === name)?.formula;
  const heads = columns.map((name) => {
    const button = h("button", { type: "button", "data-sort": name, onclick: () => press(name) }, name);
    return h("th", { scope: "col", title: formulaOf(name) }, button);
  });
  /** The filtered records, in order. */
  const found = () => {
    const own = records.filter(({ row }) => axes.every((name) => !filters[name] || row.axes[name] === filters[name]));
    const name = sort.replace(/^-/, "");
    const sign = sort.startsWith("-") ? -1 : 1;
    const isMissing = ({ fields }) => fields[name] === null || fields[name] === "";
    const compare = (a, b) => (isMissing(a) || isMissing(b) ? 1 : sign) * order(a.fields[name], b.fields[name]);
    return name ? own.sort(compare) : own;
  };
  const line = ({ row, fields }) => {
    const label = { type: "button", "aria-label": `Compare ${row.cell}` };
    const button = h("button", { ...label, onclick: () => open(row) }, "▸");
    const hasImage = row.image !== null;
    const onclick = (event) => hasImage && !event.target.closest("button") && open(row);
    // Tables of data have the code names of methods.
    const shown = (name) => (axisOf[name] && name !== "method" ? short(name, row.axes[name]) : undefined);
    const own = columns.map((name) => cellOf(fields[name], shown(name)));
    return h("tr", { class: hasImage ? "open" : "", onclick }, h("td", {}, hasImage && button), ...own);
  };
  const fill = (most) => {
    limit = most;
    const own = found();
    const [name, direction] = [sort.replace(/^-/, ""), sort.startsWith("-") ? "descending" : "ascending"];
    heads.forEach((head, i) => head.setAttribute("aria-sort", columns[i] === name ? direction : "none"));
    body.replaceChildren(...own.slice(0, limit).map(line));
    const cut = own.length > limit ? `; the first ${limit} are shown` : "";
    count.textContent = `${own.length} of ${records.length} cells${cut}`;
    more.hidden = own.length <= limit;
  };
  const picker = (name) => {
    const { values } = axisOf[name];
    const options = [["", "all"], ...values.map((value) => [value, short(name, value)])];
    return select(name, options, filters[name], (value) => {
      filters[name] = value;
      keep({ [name]: value });
      fill(PAGE_ROWS);
    });
  };
  const fieldsOf = ({ fields }) => columns.map((name) => fields[name]);
  const save = () => download("cells.csv", csvText(columns, found().map(fieldsOf)), "text/csv"); // prettier-ignore
  const button = h("button", { type: "button", onclick: save }, "Save CSV");
  const errors = (run, i) => [i ? " · " : "", h("a", { href: `${run.link}/errors.csv` }, `errors.csv of ${run.label}`)];
  fill(PAGE_ROWS);
  const head = h("tr", {}, h("th", { scope: "col" }, h("span", { class: "visually-hidden" }, "images")), ...heads);
  view.replaceChildren(
    h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Tables"), ...axes.map(picker), button),
    count,
    scrollBox("data-table", "Cells", h("table", {}, h("thead", {}, head), body)),
    more,
    ...(model.runs[0].link ? [h("p", { class: "note" }, "All columns: ", model.runs.map(errors))] : []),
  );
}
