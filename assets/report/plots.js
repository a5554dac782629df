// The figures: what is drawn of the run's data.

import { breakEvenMap, equalTimeIntervals, equalTimeMap, nDotVMap } from "report/break-even";
import { caseAxes, curveFacets, curves, facetLabel, fixedOf, open, pairs, sampleAxis, seriesAxis, seriesLabel, unique } from "report/cases";
import { COLORS, SHAPES, bars as barChart, domain, figure, heatmap, ordinal, xy } from "report/chart";
import { displayAxes, headline, model, rows, scenes, symbol, table, variantLabel, variantLabels } from "report/data";
import { choice, h, number, quartiles, select } from "report/dom";
import { go, keep } from "report/state";

/** Whether there is more than one sample count, without which nothing converges. */
export const hasConvergence = unique(curves.flatMap((curve) => curve.points.map((p) => p.samples))).length > 1;

/** Log-log convergence of one facet, with fitted slopes and the reference's noise floor. */
export function convergence(facet = curveFacets[0]) {
  const own = curves.filter((curve) => facetLabel(curve.key) === facet);
  const series = unique(own.map((curve) => curve.key[seriesAxis])), methods = unique(own.map((curve) => curve.method));
  const allFloors = own.map((curve) => curve.noise_floor).filter((x) => x > 0);
  const lowest = Math.min(...own.flatMap((curve) => curve.points.map((p) => p.error)));
  // A floor far below every error would press the curves together; it is written out instead.
  const floors = allFloors.filter((x) => x > lowest / 30), farFloor = Math.max(0, ...allFloors.filter((x) => x <= lowest / 30));
  const fixed = unique(own.map((curve) => JSON.stringify(curve.key))).flatMap((key) => fixedOf(JSON.parse(key)));
  const dash = (method) => [undefined, "7 3", "2 3", "9 3 2 3"][methods.indexOf(method) % 4];
  // With one series only, colours tell the methods apart.
  const color = (key, method) => (series.length > 1 ? ordinal(series.indexOf(key[seriesAxis]), series.length) : COLORS[methods.indexOf(method) % 7] ?? "var(--muted)");
  const shape = (curve) => SHAPES[(series.length > 1 ? series.indexOf(curve.key[seriesAxis]) : methods.indexOf(curve.method)) % SHAPES.length];
  const slopeText = (curve) => (curve.slope ? `slope ${number(curve.slope.value, 2)} [${number(curve.slope.lo, 2)}, ${number(curve.slope.hi, 2)}]` : "no fit");
  const counts = unique(own.flatMap((curve) => curve.points.map((p) => p.samples))).sort((a, b) => a - b);
  return figure({
    name: `convergence-${facet}`,
    title: facet === "all" ? "Convergence" : `Convergence · ${facet}`,
    note: "Slopes are fitted to ln(error) over ln(samples) with their 95 % interval; plain Monte Carlo has −1 in squared error. Noise floor: the error an exact image would have by the reference's own noise. Flat lines: methods without samples.",
    legend: [...own.map((curve) => ({ label: `${[methods.length > 1 || !seriesLabel(curve.key) ? curve.method : "", seriesLabel(curve.key)].filter(Boolean).join(" ")}: ${slopeText(curve)}`, color: color(curve.key, curve.method), shape: shape(curve), dash: dash(curve.method) })),
      ...unique(fixed.map((c) => c.fixed)).map((name) => ({ label: name, color: "var(--muted)", dash: "1 0" })), floors.length ? { label: "noise floor", color: "var(--muted)", dash: "1 4" } : { label: `noise floor: at most ${number(farFloor, 2)}, below the drawing`, line: false }],
    table: {
      columns: [...caseAxes, "method", "samples", headline, "slope", "slope_lo", "slope_hi", "noise_floor"],
      rows: own.flatMap((curve) => curve.points.map((p) => [...curve.key, curve.method, p.samples, p.error, curve.slope?.value ?? null, curve.slope?.lo ?? null, curve.slope?.hi ?? null, curve.noise_floor])),
      onrow: (i) => { const p = own.flatMap((curve) => curve.points)[i]; open(p.cell, p.run)(); },
    },
    draw: xy({
      x: sampleAxis(counts),
      y: { label: "relMSE", log: true, domain: domain([...own.flatMap((curve) => curve.points.map((p) => p.error)), ...fixed.map((c) => c.fixed_error), ...floors], true) },
      marks: [
        ...unique(floors).map((floor, i) => ({ rule: floor, color: "var(--muted)", dash: "1 4", opacity: 0.8, label: i === 0 ? "noise floor" : "" })),
        ...fixed.map((c) => ({ rule: c.fixed_error, color: color(c.key), width: 1, opacity: 0.8 })),
        ...own.filter((curve) => curve.slope).map((curve) => ({ line: counts.map((n) => [n, Math.exp(curve.slope.intercept) * n ** curve.slope.value]), color: color(curve.key, curve.method), width: 1, dash: "3 3", opacity: 0.6 })),
        ...own.map((curve) => ({ line: curve.points.map((p) => [p.samples, p.error]), color: color(curve.key, curve.method), dash: dash(curve.method), width: 2 })),
        ...own.map((curve) => ({ color: color(curve.key, curve.method), shape: shape(curve), r: 4, dots: curve.points.map((p) => ({ x: p.samples, y: p.error, open: open(p.cell, p.run),
          text: `${curve.method} ${p.samples} · ${seriesLabel(curve.key)}\nrelMSE ${number(p.error)}${p.is_resolved ? "" : " (limited by the reference)"}\n${slopeText(curve)}` })) })),
      ],
    }),
  });
}

/** The widest 95 % interval of the median frame time over rows, and p05 and p95; without intervals (too few rounds) these stand for it. */
function timeEnds(of) {
  const widest = (ends) => [Math.min(...ends.map(([lo]) => lo)), Math.max(...ends.map(([, hi]) => hi))];
  const [t05, t95] = widest(of.map(({ time }) => [time.p05, time.p95]));
  const known = of.map(({ time }) => time.interval).filter(([lo, hi]) => lo !== null && hi !== null);
  return { t05, t95, ends: known.length ? widest(known) : [t05, t95], isInterval: known.length > 0 };
}

/** Time against error: one mark a variant over the chosen rows, with the Pareto front. */
function timeError(facet) {
  const own = rows.filter((row) => row.time && row.scores[headline] !== null && (facet === "all" || facetLabel(caseAxes.map((name) => row.axes[name])) === facet));
  const label = (row) => variantLabel(row, ["point_set"]);
  const points = unique(own.map(label)).flatMap((name) => {
    const of = own.filter((row) => label(row) === name);
    if (!of.length) return [];
    const [lo, error, hi] = quartiles(of.map((row) => row.scores[headline]));
    const time = quartiles(of.map((row) => row.time.median))[1];
    return [{ name, method: of[0].axes.method, error, lo, hi, time, ...timeEnds(of), row: of[0], n: of.length }];
  });
  if (!points.length) return null;
  const front = points.filter((p) => !points.some((q) => q !== p && q.time <= p.time && q.error <= p.error && (q.time < p.time || q.error < p.error))).sort((a, b) => a.time - b.time);
  const methods = unique(points.map((p) => p.method));
  const cpu = model.runs.some((run) => run.timings.some((record) => record.device_type === "cpu"));
  return figure({
    name: `time-error-${facet}`,
    title: `Time against error · ${facet}`,
    note: `Median over the chosen cells; whiskers: the middle half of the errors, and ${points.every((p) => p.isInterval) ? "the 95 % interval of the median frame time (of the rounds)" : "p05 to p95 of the frame times"}. Line: the Pareto front. ${cpu ? "Times of a CPU driver say nothing about a GPU." : ""}`,
    legend: [...methods.map((method, i) => ({ label: method, color: COLORS[i % 7], shape: SHAPES[i % SHAPES.length], line: false })), { label: "Pareto front", color: "var(--muted)", dash: "5 3" }],
    table: { columns: ["variant", "frame_ms", "frame_ms_lo", "frame_ms_hi", "p05_ms", "p95_ms", headline, "lower_quartile", "upper_quartile", "cells", "on_front"], rows: points.map((p) => [p.name, p.time, ...p.ends, p.t05, p.t95, p.error, p.lo, p.hi, p.n, front.includes(p) ? "yes" : "no"]), onrow: (i) => open(points[i].row.cell, points[i].row.run)() },
    draw: xy({
      x: { label: "frame time, ms", log: true, domain: domain(points.flatMap((p) => p.ends), true) },
      y: { label: "relMSE", log: true, domain: domain(points.flatMap((p) => [p.lo, p.hi]), true) },
      marks: [
        { line: front.map((p) => [p.time, p.error]), color: "var(--muted)", dash: "5 3", width: 1.6 },
        ...methods.map((method, i) => ({ color: COLORS[i % 7], shape: SHAPES[i % SHAPES.length], r: 5, dots: points.filter((p) => p.method === method).map((p) => ({ x: p.time, y: p.error, xs: p.ends, ys: [p.lo, p.hi], open: open(p.row.cell, p.row.run),
          text: `${p.name}\n${number(p.time)} ms (${number(p.ends[0])} to ${number(p.ends[1])})\nrelMSE ${number(p.error)} (${number(p.lo)} to ${number(p.hi)}, ${p.n} cells)` })) })),
        ...points.map((p) => ({ text: p.name.replace(`${p.method} `, ""), x: p.time * 1.03, y: p.error * 0.93, color: "var(--muted)" })),
      ],
    }),
  });
}

let binRows = null;
function binsOf(row) {
  binRows ??= model.runs.map((_, run) => {
    const found = new Map(), own = table(run, "errors_by_n_dot_v.csv");
    if (!own) return found;
    const [cell, lo, hi, error] = ["cell", "n_dot_v_from", "n_dot_v_to", headline].map((name) => own.columns.indexOf(name));
    for (const fields of own.rows) {
      if (!found.has(fields[cell])) found.set(fields[cell], []);
      found.get(fields[cell]).push([Number(fields[lo]), Number(fields[hi]), Number(fields[error])]);
    }
    return found;
  });
  return binRows[row.run].get(row.cell) ?? [];
}

/** One line for each way to make a scene's image: the median over its point sets. */
function profileLines(scene) {
  const groups = new Map();
  for (const row of scene.variants) {
    const bins = binsOf(row), name = variantLabel(row, ["point_set"]);
    if (bins.length) groups.set(name, [...(groups.get(name) ?? []), { row, bins }]);
  }
  return [...groups].map(([name, members]) => ({ name, row: members[0].row, count: members.length,
    bins: members[0].bins.map(([lo, hi]) => [lo, hi, quartiles(members.flatMap(({ bins }) => bins.filter((bin) => bin[0] === lo).map((bin) => bin[2])))[1]]) }));
}

/** Error over n.v for every variant of one scene. */
export function profile(scene) {
  const own = profileLines(scene);
  if (!own.length) return null;
  const methods = unique(own.map(({ row }) => row.axes.method));
  const style = ({ row }) => {
    const same = own.filter((other) => other.row.axes.method === row.axes.method);
    return row.axes.samples === "" || same.length === 1 ? { color: COLORS[methods.indexOf(row.axes.method) % 7], width: 3, dash: "6 3" } : { color: ordinal(same.findIndex((other) => other.row === row), same.length), width: 1.8, dash: [undefined, "7 3", "2 3", "9 3 2 3"][methods.indexOf(row.axes.method) % 4] };
  };
  const middle = ([lo, hi]) => (lo + hi) / 2;
  return figure({
    name: `n-dot-v-${scene.label}`,
    title: `Error over n·v · ${scene.label}`,
    note: `relMSE over the pixels of each bin: left grazing, right facing the viewer.${own.some((one) => one.count > 1) ? " Of several point sets the median." : ""}`,
    legend: own.map((one, i) => ({ label: one.name, ...style(one), shape: SHAPES[i % SHAPES.length] })),
    table: { columns: ["variant", "n_dot_v_from", "n_dot_v_to", headline], rows: own.flatMap(({ name, bins }) => bins.map((bin) => [name, ...bin])), onrow: (i) => { const { row } = own.flatMap((one) => one.bins.map(() => one))[i]; open(row.cell, row.run)(); } },
    draw: xy({
      x: { label: "n·v", domain: [0, 1] },
      y: { label: "relMSE", log: true, domain: domain(own.flatMap(({ bins }) => bins.map((bin) => bin[2])), true) },
      marks: [
        ...own.map((one) => ({ line: one.bins.map((bin) => [middle(bin), bin[2]]), ...style(one) })),
        ...own.map((one, i) => ({ color: style(one).color, shape: SHAPES[i % SHAPES.length], dots: one.bins.map((bin) => ({ x: middle(bin), y: bin[2], open: open(one.row.cell, one.row.run), text: `${one.name}\nn·v ${bin[0]} to ${bin[1]}: relMSE ${number(bin[2])}` })) })),
      ],
    }),
  });
}

/** The visible difference (FLIP) of every variant by exposure and contrast. */
function visibility() {
  const own = rows.filter((row) => row.scores.flip !== null);
  const setting = (row) => displayAxes.map((name) => `${name} ${row.axes[name]}`).join(" · ");
  const columns = unique(own.map(setting)), lines = variantLabels.filter((name) => own.some((row) => variantLabel(row) === name));
  const of = (r, c) => own.filter((row) => variantLabel(row) === lines[r] && setting(row) === columns[c]);
  const value = (r, c) => quartiles(of(r, c).map((row) => row.scores.flip))[1];
  const largest = Math.max(...own.map((row) => row.scores.flip));
  const places = lines.flatMap((_, r) => columns.map((_, c) => [r, c])).filter(([r, c]) => of(r, c).length);
  return figure({
    name: "visibility",
    class: "wide",
    title: "Visible difference (FLIP) by exposure and contrast",
    note: "Median over all scenes; 0 is equal. Columns share one linear image: the tone curve hides or shows its error. Click for the image at that setting.",
    height: () => 110 + 30 * lines.length,
    table: { columns: ["variant", ...displayAxes, "flip", "cells"], rows: places.map(([r, c]) => [lines[r], ...displayAxes.map((name) => of(r, c)[0].axes[name]), value(r, c), of(r, c).length]),
      onrow: (i) => { const [row] = of(...places[i]); open(row.cell, row.run)(); } },
    draw: heatmap({
      rows: lines, columns, rowTitle: "", columnTitle: "",
      cell: (r, c) => {
        const flip = value(r, c);
        if (!Number.isFinite(flip)) return { text: "", title: `${lines[r]}, ${columns[c]}: no result` };
        const step = Math.round((flip / largest) * 6), row = of(r, c)[0];
        return { text: number(flip, 2), color: `var(--heat-${step})`, ink: `var(--heat-ink-${step})`, title: `${lines[r]}, ${columns[c]}: FLIP ${number(flip)}`,
          open: () => go({ view: "compare", cell: row.cell, run: row.run || undefined }) };
      },
    }),
  });
}

/** Pass times stacked, one bar a configuration. */
function passes(phase, title, note) {
  const bars = model.runs.flatMap((run, index) => run.timings.filter((record) => record.phase === phase).map((record) => {
    const words = ["brdf", "method", "samples", "diffuse"].map((name) => record.axes[name]).filter((word) => word && word !== "none");
    const name = [model.runs.length > 1 ? run.label : "", ...words].filter(Boolean).join(" ") || record.environment_size.join("×");
    // The first cell of this configuration stands for all that were timed as one; what is made once has none.
    const shown = phase === "frame" && rows.find((row) => row.run === index && Object.entries(record.axes).every(([axis, value]) => !value || (row.axes[axis] ?? value) === value));
    return { name, parts: record.passes, total: record.passes.reduce((sum, [, ms]) => sum + ms, 0), order: `${record.axes.brdf} ${record.axes.method} ${String(record.axes.samples).padStart(6, "0")}`, run: index, open: shown && open(shown.cell, shown.run) };
  })).sort((a, b) => a.run - b.run || (a.order < b.order ? -1 : 1));
  if (!bars.length) return null;
  const names = unique(bars.flatMap((bar) => bar.parts.map(([name]) => name)));
  return figure({
    name: `passes-${phase}`,
    title, note,
    legend: names.map((name, i) => ({ label: name, color: COLORS[i % 7], shape: "square", line: false })),
    height: () => 22 * bars.length,
    table: { columns: ["configuration", "pass", "median_ms"], rows: bars.flatMap((bar) => bar.parts.map(([name, ms]) => [bar.name, name, ms])),
      onrow: bars.some((bar) => bar.open) && ((i) => bars.flatMap((bar) => bar.parts.map(() => bar))[i].open?.()) },
    draw: barChart({ bars, parts: names, unit: "ms" }),
  });
}

/** The page of plots. */
export function showPlots(view, state) {
  const groups = [], isTimed = rows.some((row) => row.time);
  const facets = curveFacets.length ? curveFacets : ["all"];
  const facet = facets.includes(state.facet) ? state.facet : facets[0];
  const scene = scenes.find((one) => one.key === state.scene) ?? scenes[0];
  const again = (details) => { keep(details); showPlots(view, { ...state, ...details }); };
  const pair = pairs.find((one) => `${one.sampled} ${one.fixed}` === state.pair) ?? pairs[0];
  const bar = h("div", { class: "controls" }, h("h2", { tabindex: -1 }, "Plots"),
    pairs.length > 1 && select("Methods", pairs.map((p) => [`${p.sampled} ${p.fixed}`, `${p.sampled} against ${p.fixed}`]), `${pair.sampled} ${pair.fixed}`, (value) => again({ pair: value })),
    facets.length > 1 && select("Show", facets.map((f) => [f, f]), facet, (value) => again({ facet: value })));
  if (hasConvergence) groups.push(convergence(facet));
  groups.push(timeError(state.all === "1" || !curves.length ? "all" : facet));
  if (pair) groups.push(breakEvenMap(pair), equalTimeMap(pair), equalTimeIntervals(pair, facet), nDotVMap(pair, facet));
  groups.push(profile(scene));
  if (displayAxes.length) groups.push(visibility());
  groups.push(passes("frame", "Time of a frame by pass", "Median of each pass, in running order."), passes("precompute", "Made once per environment or model", "Apart from the frame: tables that every frame uses."));
  bar.append(...[
    scenes.length > 1 && select("Profile of", scenes.map((one) => [one.key, one.label]), scene.key, (value) => again({ scene: value })),
    curves.length > 0 && isTimed && h("span", { class: "choice" }, "Time plot"), curves.length > 0 && isTimed && choice("Cells of the time plot", [["0", "This setting"], ["1", "All cells"]], state.all === "1" ? "1" : "0", (value) => again({ all: value }))].filter(Boolean));
  const links = model.figures.length > 0 && h("p", { class: "note" }, "Data and Vega-Lite specifications beside this report: ",
    model.figures.map((name, i) => [i ? ", " : "", h("a", { href: `${name.split("/").map(encodeURIComponent).join("/")}.vl.json` }, `${name.split("/").at(-1)}.vl.json`)]), ".");
  view.replaceChildren(bar, h("div", { class: "figures" }, groups.filter(Boolean)), links || "");
}
