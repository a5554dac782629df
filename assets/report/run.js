// The page of the run: where the numbers come from, what is missing.

import { model, short } from "report/data";
import { h, number, scrollBox, tableHead } from "report/dom";

/** The contact sheets beside the report, which hold every image of a scene as pictures. */
export const sheetLinks = (run) => h("p", { class: "sheets" }, run.sheets.map(([name, link], i) => [i ? " · " : "", h("a", { href: link }, name)]));

/** More rows would only make the page slow; the experiment file has the rules. */
const EXCLUDED_MAX = 500;

/** What the experiment leaves out for this reason, combination by combination. */
function excludedList(run, why) {
  const { axes, points, reasons } = model.exclusions, at = axes.indexOf("run");
  const own = points.filter(([reason, values]) => reasons[reason] === why && (at < 0 || values[at] === "" || values[at] === run.label)).map(([, values]) => values);
  if (!own.length) return h("p", { class: "note" }, "Each of them is left out for another reason, too, or another combination makes the same image.");
  // What is the same in all of them that have it is said once.
  const valuesAt = (i) => [...new Set(own.map((values) => values[i]).filter(Boolean))];
  const varied = axes.map((name, i) => [name, i]).filter(([name, i]) => name !== "run" && valuesAt(i).length > 1);
  const fixed = axes.map((name, i) => [name, valuesAt(i)]).filter(([name, values]) => name !== "run" && values.length === 1).map(([name, [value]]) => [name, value]);
  const cell = (name, value) => h("td", { title: value }, value === "" ? "any" : short(name, value));
  return [
    fixed.length > 0 && h("p", { class: "note" }, `In all: ${fixed.map(([name, value]) => `${name} ${short(name, value)}`).join(", ")}.`),
    varied.length > 0 && scrollBox("Excluded combinations", h("table", {}, h("thead", {}, h("tr", {}, varied.map(([name]) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, own.slice(0, EXCLUDED_MAX).map((values) => h("tr", {}, varied.map(([name, i]) => cell(name, values[i]))))))),
    own.length > EXCLUDED_MAX && h("p", { class: "note" }, `The first ${EXCLUDED_MAX} of ${own.length}; the experiment file below has the rules.`),
  ];
}

/** The page of the run: where the numbers come from, what is missing. */
export function showRun(view) {
  const list = (entries) => h("dl", {}, entries.filter(([, text]) => text !== "" && text !== undefined && text !== null).map(([name, text]) => [h("dt", {}, name), h("dd", {}, String(text))]));
  const parts = [h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Run"))];
  if (model.runs.length > 1) {
    parts.push(h("h2", {}, "What tells the runs apart"), model.facts.some((fact) => fact.differs) ? "" : h("p", { class: "note" }, "Nothing: all that is known of the runs is the same."), scrollBox("What tells the runs apart", h("table", { class: "plain" }, tableHead(["", ...model.runs.map((run) => run.label)], "fact"),
      h("tbody", {}, model.facts.map(({ what, values, differs }) => h("tr", { class: differs ? "differs" : "" }, h("th", { scope: "row" }, what), values.map((text) => h("td", {}, text || "–"))))))),
      h("p", { class: "note" }, "Bold: not the same in all."));
  }
  for (const run of model.runs) {
    const p = run.provenance, session = p.sessions?.at(-1) ?? {}, device = session.device ?? {}, host = session.host ?? {};
    parts.push(model.runs.length > 1 ? h("h2", { class: "run-head" }, run.label) : h("h2", {}, "Where the numbers come from"));
    parts.push(h("p", { class: run.outdated ? "warning" : "note" }, `The answers and charts of this page were computed from the run's tables by splitsum ${model.program_version} when the page was written. ${run.outdated ?? ""}`));
    parts.push(h("div", { class: "facts-grid" },
      h("section", {}, h("h3", {}, "Device"), list([["name", device.name], ["type", device.type], ["driver", device.driver], ["Vulkan", device.api_version], ["memory", device.memory_bytes && `${number(device.memory_bytes / 2 ** 30)} GiB`], ["timestamp period", device.timestamp_period_ns && `${device.timestamp_period_ns} ns`]])),
      h("section", {}, h("h3", {}, "Host"), list([["CPU", host.cpu], ["threads", host.cpu_count], ["system", host.os && `${host.os} ${host.arch}`], ["load", host.load_average?.join(", ")], ["date", session.date_utc], ["sessions", p.sessions?.length]])),
      h("section", {}, h("h3", {}, "Program"), list([["version", session.program_version], ["commit", session.commit && `${session.commit.hash}${session.commit.dirty ? " (changed)" : ""}`], ["shaders", p.shader_hash], ["command", session.command_line?.join(" ")]])),
      h("section", {}, h("h3", {}, "Experiment"), list([["file", p.experiment_file], ["hash", p.experiment_hash], ["plan", p.plan_hash], ["overrides", p.overrides?.join(" ")], ["seed", p.seed], ["cells", p.cell_count], ...Object.entries(p.inputs ?? {}).map(([name, hash]) => [name, hash])]))));
    parts.push(h("h2", {}, "Failed cells"), run.failures.length ? scrollBox("Failed cells", h("table", { class: "plain" }, tableHead(["cell", "what", "why"]), h("tbody", {}, run.failures.map((f) => h("tr", {}, h("td", {}, f.cell), h("td", {}, f.label), h("td", {}, f.reason)))))) : h("p", { class: "note" }, "None."));
    parts.push(h("h2", {}, "Excluded combinations"), run.excluded.length ? h("div", { class: "excluded-list" }, run.excluded.map((one) => h("details", {}, h("summary", {}, `${one.count}: ${one.why}`), excludedList(run, one.why)))) : h("p", { class: "note" }, "None."));
    if (p.input_warnings?.length) parts.push(h("h2", {}, "Warnings about inputs"), h("ul", {}, p.input_warnings.map((text) => h("li", {}, text))));
    if (run.sheets.length) parts.push(h("h2", {}, "Contact sheets"), sheetLinks(run));
    parts.push(h("details", {}, h("summary", {}, "Experiment file"), h("pre", {}, run.experiment)), h("details", {}, h("summary", {}, "Provenance, whole"), h("pre", {}, JSON.stringify(p, null, 2))));
  }
  parts.push(h("h2", {}, "Metrics"), scrollBox("Metrics", h("table", { class: "plain" }, tableHead(["name", "formula", "space", "better", "version"]), h("tbody", {}, model.metrics.map((m) => h("tr", {}, h("th", { scope: "row" }, m.name), [m.formula, m.space, m.better, m.version].map((text) => h("td", {}, String(text)))))))));
  view.replaceChildren(...parts);
}
