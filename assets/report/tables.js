// Tables: sort by a column, filter by words, save as CSV, follow a row to its images.

import { axisOf, model, rowOf, table } from "report/data";
import { choice, download, h, number, select } from "report/dom";
import { go, keep } from "report/state";

const FILES = [["errors.csv", "Errors"], ["errors_by_n_dot_v.csv", "Errors by n·v"], ["timings.csv", "Timings"]];
/** Rows put on the page at once; a button adds as many again. */
const PAGE_ROWS = 200;

const isNumber = (text) => text !== "" && (Number.isFinite(Number(text)) || text === "inf" || text === "-inf");
const value = (text) => (text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text));

/** Rows that hold every word of the filter; a word may name a column: `alpha=0.1`, `rmse<0.5`. */
function matches(columns, filter) {
  const tests = filter.toLowerCase().split(/\s+/).filter(Boolean).map((word) => {
    const [, name, sign, wanted] = word.match(/^([\w-]+)(<=|>=|=|<|>)(.+)$/) ?? [];
    const place = columns.findIndex((column) => column.toLowerCase() === name);
    if (place < 0) return (row) => row.some((field) => field.toLowerCase().includes(word));
    const compare = { "=": (a) => a.toLowerCase() === wanted || (isNumber(a) && value(a) === Number(wanted)), "<": (a) => a !== "" && value(a) < Number(wanted), ">": (a) => a !== "" && value(a) > Number(wanted), "<=": (a) => a !== "" && value(a) <= Number(wanted), ">=": (a) => a !== "" && value(a) >= Number(wanted) }[sign];
    return (row) => compare(row[place]);
  });
  return (row) => tests.every((test) => test(row));
}

/** The page of tables. */
export function showTables(view, state) {
  const files = FILES.filter(([name]) => model.runs.some((_, run) => table(run, name)));
  const file = files.find(([name]) => name === state.table)?.[0] ?? files[0][0];
  const run = Number(state.run) || 0, own = table(run, file);
  const bar = h("div", { class: "controls" }, h("h2", { tabindex: -1 }, "Tables"));
  if (!own) return view.replaceChildren(bar, h("p", { class: "note" }, `This run has no ${file}.`));
  const { columns, rows, text } = own;
  const isIdle = (name, i) => name === "cell" || ((axisOf[name] || name === "diffuse_weight" || name === "device") && new Set(rows.map((row) => row[i]).filter(Boolean)).size < 2);
  const all = state.columns === "all";
  const shown = columns.map((name, i) => [name, i]).filter(([name, i]) => all || !isIdle(name, i));
  let sort = columns.includes(state.sort?.replace(/^-/, "")) ? state.sort : "", filter = state.filter ?? "", limit = PAGE_ROWS;
  const again = (details) => { keep(details); showTables(view, { ...state, ...details }); };

  const body = h("tbody", {}), count = h("p", { class: "note", "aria-live": "polite" }), more = h("button", { type: "button", onclick: () => { limit += PAGE_ROWS; fill(); } }, "Show more rows");
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
    const found = rows.filter(matches(columns, filter));
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
  const box = h("input", { type: "search", value: filter, placeholder: "words, alpha=0.1, rmse<0.5", oninput: () => { filter = box.value; limit = PAGE_ROWS; keep({ filter }); fill(); } });
  bar.append(
    choice("Table", files, file, (name) => again({ table: name, sort: "", filter: "" })),
    model.runs.length > 1 ? select("Run", model.runs.map((one, i) => [i, one.label]), run, (value) => again({ run: value })) : "",
    h("label", { class: "choice" }, h("span", {}, "Filter"), box),
    h("label", { class: "check" }, h("input", { type: "checkbox", checked: all, onchange: (event) => again({ columns: event.target.checked ? "all" : "" }) }), " all columns"),
    h("button", { type: "button", onclick: () => download(file, text, "text/csv") }, `Save ${file}`));
  fill();
  view.replaceChildren(bar, count, h("div", { class: "scroll data-table", tabindex: 0, role: "region", "aria-label": file }, h("table", {}, h("thead", {}, h("tr", {}, h("th", {}), heads)), body)), more);
  return undefined;
}

const openRow = (row) => go({ view: "compare", cell: row.cell, run: row.run || undefined });

/** The page of the run: where the numbers come from, what is missing. */
export function showRun(view) {
  const list = (entries) => h("dl", {}, entries.filter(([, text]) => text !== "" && text !== undefined && text !== null).map(([name, text]) => [h("dt", {}, name), h("dd", {}, String(text))]));
  const parts = [h("div", { class: "controls" }, h("h2", { tabindex: -1 }, "Run"))];
  if (model.runs.length > 1) {
    parts.push(h("h3", {}, "What tells the runs apart"), h("div", { class: "scroll" }, h("table", { class: "plain" }, h("thead", {}, h("tr", {}, ["", ...model.runs.map((run) => run.label)].map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, model.differences.map(([name, values]) => h("tr", {}, h("th", { scope: "row" }, name), values.map((text) => h("td", {}, text))))))),
      h("p", { class: "note" }, model.differences.length ? "Everything else in their provenance is equal." : "Their provenance is equal."));
  }
  for (const run of model.runs) {
    const p = run.provenance, session = p.sessions?.at(-1) ?? {}, device = session.device ?? {}, host = session.host ?? {};
    if (model.runs.length > 1) parts.push(h("h3", { class: "run-head" }, run.label));
    parts.push(h("div", { class: "facts-grid" },
      h("section", {}, h("h4", {}, "Device"), list([["name", device.name], ["type", device.type], ["driver", device.driver], ["Vulkan", device.api_version], ["memory", device.memory_bytes && `${number(device.memory_bytes / 2 ** 30)} GiB`], ["timestamp period", device.timestamp_period_ns && `${device.timestamp_period_ns} ns`]])),
      h("section", {}, h("h4", {}, "Host"), list([["CPU", host.cpu], ["threads", host.cpu_count], ["system", host.os && `${host.os} ${host.arch}`], ["load", host.load_average?.join(", ")], ["date", session.date_utc], ["sessions", p.sessions?.length]])),
      h("section", {}, h("h4", {}, "Program"), list([["version", session.program_version], ["commit", session.commit && `${session.commit.hash}${session.commit.dirty ? " (changed)" : ""}`], ["shaders", p.shader_hash], ["command", session.command_line?.join(" ")]])),
      h("section", {}, h("h4", {}, "Experiment"), list([["file", p.experiment_file], ["hash", p.experiment_hash], ["plan", p.plan_hash], ["overrides", p.overrides?.join(" ")], ["seed", p.seed], ["cells", p.cell_count], ...Object.entries(p.inputs ?? {}).map(([name, hash]) => [name, hash])]))));
    parts.push(h("h3", {}, "Failed cells"), run.failures.length ? h("div", { class: "scroll" }, h("table", { class: "plain" }, h("thead", {}, h("tr", {}, ["cell", "what", "why"].map((name) => h("th", { scope: "col" }, name)))), h("tbody", {}, run.failures.map((f) => h("tr", {}, h("td", {}, f.cell), h("td", {}, f.label), h("td", {}, f.reason)))))) : h("p", { class: "note" }, "None."));
    parts.push(h("h3", {}, "Excluded combinations"), run.excluded.length ? h("ul", {}, run.excluded.map((one) => h("li", {}, `${one.count}: ${one.why}`))) : h("p", { class: "note" }, "None."));
    if (p.input_warnings?.length) parts.push(h("h3", {}, "Warnings about inputs"), h("ul", {}, p.input_warnings.map((text) => h("li", {}, text))));
    parts.push(h("details", {}, h("summary", {}, "Experiment file"), h("pre", {}, run.experiment)), h("details", {}, h("summary", {}, "Provenance, whole"), h("pre", {}, JSON.stringify(p, null, 2))));
  }
  parts.push(h("h3", {}, "Metrics"), h("div", { class: "scroll" }, h("table", { class: "plain" }, h("thead", {}, h("tr", {}, ["name", "formula", "space", "better", "version"].map((name) => h("th", { scope: "col" }, name)))), h("tbody", {}, model.metrics.map((m) => h("tr", {}, h("th", { scope: "row" }, m.name), [m.formula, m.space, m.better, m.version].map((text) => h("td", {}, String(text)))))))));
  view.replaceChildren(...parts);
}
