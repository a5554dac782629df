// Times: against error, by pass, and when tables that are made once have paid for themselves. Times of two devices never share a figure.

import { caseAxes, facetLabel, open, runSuffix, runTitle, sharedRows, sharedText, unique } from "report/cases";
import { COLORS, SHAPES, domain, figure, xy } from "report/chart";
import { headline, model, rows, variantLabel } from "report/data";
import { h, number, quartiles, scrollBox, tableHead } from "report/dom";
import { bars as barChart } from "report/maps";

const cpuNote = (run) => (model.runs[run].timings.some((record) => record.device_type === "cpu") ? " Times of a CPU driver say nothing about a GPU." : "");

/** The widest 95 % interval of the median frame time over rows, and p05 and p95; without intervals (few rounds) these stand for it. */
function timeEnds(of) {
  const widest = (ends) => [Math.min(...ends.map(([lo]) => lo)), Math.max(...ends.map(([, hi]) => hi))];
  const [t05, t95] = widest(of.map(({ time }) => [time.p05, time.p95]));
  const known = of.map(({ time }) => time.interval).filter((ends) => ends && ends[0] !== null && ends[1] !== null);
  return { t05, t95, ends: known.length ? widest(known) : [t05, t95], isInterval: known.length > 0 };
}

/** Time against error of one run: one mark a variant over the chosen rows; those on the Pareto front are ringed. */
export function timeError(run, facet) {
  const all = rows.filter((row) => row.run === run && row.time && row.scores[headline] !== null && (facet === "all" || facetLabel(caseAxes.map((name) => row.axes[name])) === facet));
  const label = (row) => variantLabel(row, ["point_set", "run"]), common = sharedRows(all, label, (row) => row.scene.key), { own } = common;
  const points = unique(own.map(label)).map((name) => {
    const of = own.filter((row) => label(row) === name), [lo, error, hi] = quartiles(of.map((row) => row.scores[headline]));
    return { name, method: of[0].axes.method, error, lo, hi, time: quartiles(of.map((row) => row.time.median))[1], ...timeEnds(of), row: of[0], n: of.length };
  });
  if (!points.length) return null;
  // Medians of different scenes say nothing of each other.
  const front = !common.shared ? [] : points.filter((p) => !points.some((q) => q !== p && q.time <= p.time && q.error <= p.error && (q.time < p.time || q.error < p.error)));
  const methods = unique(points.map((p) => p.method));
  return figure({
    name: `time-error-${facet}${runSuffix(run)}`,
    title: `Time against error · ${facet}${runTitle(run)}`,
    note: `Median over the chosen cells.${sharedText(common, "scenes")} Whiskers: the middle half of the errors, and ${points.every((p) => p.isInterval) ? "the 95 % interval of the median frame time (of the rounds)" : "p05 to p95 of the frame times"}. ${front.length ? "Ringed: on the Pareto front, no other is both faster and closer." : ""}${cpuNote(run)}`,
    legend: [...methods.map((method, i) => ({ label: method, color: COLORS[i % 7], shape: SHAPES[i % SHAPES.length], line: false })), ...(front.length ? [{ label: "on the Pareto front", color: "var(--ink)", shape: "ring", line: false }] : [])],
    table: { columns: ["variant", "frame_ms", "frame_ms_lo", "frame_ms_hi", "p05_ms", "p95_ms", headline, "lower_quartile", "upper_quartile", "cells", "on_front"], rows: points.map((p) => [p.name, p.time, ...p.ends, p.t05, p.t95, p.error, p.lo, p.hi, p.n, front.includes(p) ? "yes" : "no"]), onrow: (i) => open(points[i].row.cell, points[i].row.run)() },
    draw: xy({
      x: { label: "frame time, ms", log: true, domain: domain(points.flatMap((p) => p.ends), true) },
      y: { label: "relMSE", log: true, domain: domain(points.flatMap((p) => [p.lo, p.hi]), true) },
      marks: [
        { shape: "ring", color: "var(--ink)", r: 8.5, dots: front.map((p) => ({ x: p.time, y: p.error })) },
        ...methods.map((method, i) => ({ color: COLORS[i % 7], shape: SHAPES[i % SHAPES.length], r: 5, dots: points.filter((p) => p.method === method).map((p) => ({ x: p.time, y: p.error, xs: p.ends, ys: [p.lo, p.hi], open: open(p.row.cell, p.row.run),
          text: `${p.name}${front.includes(p) ? " · on the Pareto front" : ""}\n${number(p.time)} ms (${number(p.ends[0])} to ${number(p.ends[1])})\nrelMSE ${number(p.error)} (${number(p.lo)} to ${number(p.hi)}, ${p.n} ${p.n === 1 ? "cell" : "cells"})` })) })),
        ...points.map((p) => ({ text: p.name.replace(`${p.method} `, ""), x: p.time, y: p.error, dx: 11, dy: -8, color: "var(--muted)" })),
      ],
    }),
  });
}

const PASSES = {
  frame: ["Time of a frame by pass", "Number and length: the median of the whole frame, summed round by round; the parts share it as the medians of the passes do, which alone do not add up to it."],
  precompute: ["Made once per environment or model", "Apart from the frame: tables that every frame uses. Number and length: the median of their sum, round by round."],
};

/** The words that tell timed configurations of a run apart. */
function configuration(run, axes, device, environmentSize) {
  const { timings } = model.runs[run], named = ["brdf", "method", "samples", "diffuse"], words = named.map((name) => axes[name]).filter((word) => word && word !== "none");
  const isSwept = (name) => !named.includes(name) && axes[name] && unique(timings.map((record) => record.axes[name]).filter(Boolean)).length > 1;
  words.push(...Object.keys(axes).filter(isSwept).map((name) => `${name} ${axes[name]}`));
  const more = [[(record) => record.device, device], [(record) => record.environment_size.join("×"), environmentSize.join("×")]];
  const telling = more.filter(([of]) => unique(timings.map(of)).length > 1).map(([, text]) => text);
  return [...words, ...telling].join(" ") || environmentSize.join("×");
}

/** Passes of one kind as one part: the levels of a prefiltered map, "prefilter mip 2", are passes of their own. */
function byKind(passes) {
  const sums = new Map();
  for (const [name, ms] of passes) { const [kind] = name.split(" "); sums.set(kind, (sums.get(kind) ?? 0) + ms); }
  return [...sums];
}

/** Pass times of a run stacked, one bar a configuration. */
export function passes(run, phase) {
  const [title, note] = PASSES[phase];
  const bars = model.runs[run].timings.filter((record) => record.phase === phase).map((record) => {
    // The first cell of this configuration stands for all that were timed as one; what is made once has none.
    const shown = phase === "frame" && rows.find((row) => row.run === run && Object.entries(record.axes).every(([axis, value]) => !value || (row.axes[axis] ?? value) === value));
    return { name: configuration(run, record.axes, record.device, record.environment_size), parts: byKind(record.passes), passes: record.passes, total: record.total,
      order: `${record.axes.brdf} ${record.axes.method} ${String(record.axes.samples).padStart(6, "0")}`, open: shown && open(shown.cell, shown.run) };
  }).sort((a, b) => (a.order < b.order ? -1 : 1));
  if (!bars.length) return null;
  const names = unique(bars.flatMap((bar) => bar.parts.map(([name]) => name)));
  const lines = (bar) => [...bar.passes, ["all passes, round by round", bar.total]];
  return figure({
    name: `passes-${phase}${runSuffix(run)}`,
    title: `${title}${runTitle(run)}`, note: `${note}${cpuNote(run)}`,
    legend: names.map((name, i) => ({ label: name, color: COLORS[i % 7], shape: "square", line: false })),
    height: () => 22 * bars.length,
    table: { columns: ["configuration", "pass", "median_ms"], rows: bars.flatMap((bar) => lines(bar).map(([name, ms]) => [bar.name, name, ms])),
      onrow: bars.some((bar) => bar.open) && ((i) => bars.flatMap((bar) => lines(bar).map(() => bar))[i].open?.()) },
    draw: barChart({ bars, parts: names, unit: "ms" }),
  });
}

/** Rows of the table of paybacks that are shown at once. */
const PAYBACK_ROWS = 12;

/** After how many frames the tables of a method without samples are cheaper than sampling; null where no two methods were timed together. */
export function paybackTable(run) {
  const all = model.runs[run].paybacks;
  if (!all.length) return null;
  const ends = ({ interval: [lo, hi] }) => (lo === null || hi === null ? "" : ` (${number(lo, 2)} to ${number(hi, 2)})`);
  const line = (one) => h("tr", {}, h("th", { scope: "row" }, configuration(run, one.fixed, one.device, one.environment_size)), h("td", {}, [one.sampled.method, one.sampled.samples].filter(Boolean).join(" ")),
    h("td", { class: "number payback" }, one.payback || "tables not timed"), h("td", { class: "number" }, `× ${number(one.ratio)}${ends(one)}`), h("td", { class: "number" }, `${number(one.tables_ms)} ms`));
  const body = h("tbody", {}, all.slice(0, PAYBACK_ROWS).map(line));
  const more = all.length > PAYBACK_ROWS && h("button", { type: "button", onclick: () => { body.append(...all.slice(PAYBACK_ROWS).map(line)); more.remove(); } }, `Show all ${all.length}`);
  return h("section", { class: "payback-table" }, h("h2", {}, `When the tables have paid for themselves${runTitle(run)}`),
    h("p", { class: "note" }, `Frames after which a method with tables made once has cost less than one that samples. Time ratio: sampling over it, the median of the ratios round by round with its 95 % interval, not the quotient of two medians.${cpuNote(run)}`),
    scrollBox("When the tables have paid for themselves", h("table", {}, tableHead(["with tables", "against", "frames to pay back", "time ratio", "tables, beyond its"]), body)), more);
}
