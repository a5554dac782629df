// The figures: what is drawn of the run's data.

import { breakEvenMap, equalTimeIntervals, equalTimeMap, nDotVMap } from "report/break-even";
import { caseAxes, curveFacets, curves, facetLabel, fixedOf, isJoined, open, ordered, pairs, runSuffix, runTitle, sampleAxis, seriesAxis, seriesLabel, unique } from "report/cases";
import { COLORS, DASHES, SHAPES, domain, figure, ordinal, xy } from "report/chart";
import { headline, model, rows, scenes } from "report/data";
import { choice, h, number, redraw, select } from "report/dom";
import { ENERGY, effectAxes, effectsFigure, rangeFigure, sweepFigure } from "report/effects";
import { energyFigure, isFurnace } from "report/energy";
import { profile, profileGroups } from "report/profile";
import { keep, state as current } from "report/state";
import { passes, paybackTable, timeError } from "report/times";
import { visibility } from "report/visibility";

/** Lines of methods without samples, told apart. */
const FIXED_DASHES = ["1 0", "12 4", "5 4"];

/** Whether a curve has more than one sample count, without which nothing converges. */
const isLine = (curve) => new Set(curve.points.map((p) => p.samples)).size > 1;
const facetOf = (curve) => curve && facetLabel(curve.key);

/** Log-log convergence of one facet, with fitted slopes and the reference's noise floor; null where no curve of it has two counts. */
export function convergence(run, facet = facetOf(curves.find((curve) => curve.run === run && isLine(curve)))) {
  const own = curves.filter((curve) => curve.run === run && facetOf(curve) === facet);
  if (!own.some(isLine)) return null;
  const series = ordered(unique(own.map((curve) => curve.key[seriesAxis]))), methods = unique(own.map((curve) => curve.method));
  const allFloors = own.map((curve) => curve.noise_floor).filter((x) => x > 0);
  const lowest = Math.min(...own.flatMap((curve) => curve.points.map((p) => p.error)));
  // A floor far below every error would press the curves together; it is written out instead.
  const floors = allFloors.filter((x) => x > lowest / 30), farFloor = Math.max(0, ...allFloors.filter((x) => x <= lowest / 30));
  const fixed = unique(own.map((curve) => JSON.stringify(curve.key))).flatMap((key) => fixedOf(JSON.parse(key), run));
  const dash = (method) => DASHES[methods.indexOf(method) % DASHES.length], fixedNames = unique(fixed.map((c) => c.fixed));
  const shapeOf = (key, method) => SHAPES[(series.length > 1 ? series.indexOf(key[seriesAxis]) : methods.indexOf(method)) % SHAPES.length];
  // With one series only, colours tell the methods apart.
  const color = (key, method) => (series.length > 1 ? ordinal(series.indexOf(key[seriesAxis]), series.length) : COLORS[methods.indexOf(method) % 7] ?? "var(--muted)");
  const shape = (curve) => shapeOf(curve.key, curve.method);
  const slopeText = (curve) => (curve.slope ? `slope ${number(curve.slope.value, 2)} [${number(curve.slope.lo, 2)}, ${number(curve.slope.hi, 2)}]` : "no fit");
  const counts = unique(own.flatMap((curve) => curve.points.map((p) => p.samples))).sort((a, b) => a - b);
  return figure({
    name: `convergence-${facet}${runSuffix(run)}`,
    title: `${facet === "all" ? "Convergence" : `Convergence · ${facet}`}${runTitle(run)}`,
    note: "Slopes are fitted to ln(error) over ln(samples) with their 95 % interval; plain Monte Carlo has −1 in squared error. Noise floor: the error an exact image would have by the reference's own noise. Flat lines, marked at their ends: methods without samples.",
    legend: [...own.map((curve) => ({ label: `${[methods.length > 1 || !seriesLabel(curve.key) ? curve.method : "", seriesLabel(curve.key)].filter(Boolean).join(" ")}: ${slopeText(curve)}`, color: color(curve.key, curve.method), shape: shape(curve), dash: dash(curve.method), line: isLine(curve) })),
      ...fixedNames.map((name, i) => ({ label: name, color: "var(--muted)", dash: FIXED_DASHES[i % FIXED_DASHES.length] })), floors.length ? { label: "noise floor", color: "var(--muted)", dash: "1 4" } : { label: `noise floor: at most ${number(farFloor, 2)}, below the drawing`, line: false }],
    table: {
      columns: [...caseAxes, "method", "samples", headline, "slope", "slope_lo", "slope_hi", "noise_floor"],
      rows: own.flatMap((curve) => curve.points.map((p) => [...curve.key, curve.method, p.samples, p.error, curve.slope?.value ?? null, curve.slope?.lo ?? null, curve.slope?.hi ?? null, curve.noise_floor])),
      onrow: (i) => { const p = own.flatMap((curve) => curve.points)[i]; open(p.cell, p.run)(); },
    },
    draw: xy({
      x: sampleAxis(counts, `convergence-${facet}`),
      y: { label: "relMSE", log: true, share: `convergence-${facet} y`, domain: domain([...own.flatMap((curve) => curve.points.map((p) => p.error)), ...fixed.map((c) => c.fixed_error), ...floors], true) },
      marks: [
        ...unique(floors).map((floor, i) => ({ rule: floor, color: "var(--muted)", dash: "1 4", opacity: 0.8, label: i === 0 ? "noise floor" : "" })),
        ...fixed.map((c) => ({ rule: c.fixed_error, color: color(c.key), width: 1, opacity: 0.8, dash: FIXED_DASHES[fixedNames.indexOf(c.fixed) % FIXED_DASHES.length] })),
        ...own.filter((curve) => curve.slope).map((curve) => ({ line: counts.map((n) => [n, Math.exp(curve.slope.intercept) * n ** curve.slope.value]), color: color(curve.key, curve.method), width: 1, dash: "3 3", opacity: 0.6 })),
        ...own.map((curve) => ({ line: curve.points.map((p) => [p.samples, p.error]), color: color(curve.key, curve.method), dash: dash(curve.method), width: 2 })),
        // At the ends of a flat line the mark of its curve: colour alone would not tell it from the others.
        ...fixed.map((c) => ({ color: color(c.key), shape: shapeOf(c.key), r: 4, dots: [counts[0], counts.at(-1)].map((x) => ({ x, y: c.fixed_error, open: open(c.fixed_cell, c.fixed_run),
          text: `${[c.fixed, seriesLabel(c.key)].filter(Boolean).join(" · ")}\nrelMSE ${number(c.fixed_error)}` })) })),
        ...own.map((curve) => ({ color: color(curve.key, curve.method), shape: shape(curve), r: 4, dots: curve.points.map((p) => ({ x: p.samples, y: p.error, open: open(p.cell, p.run),
          text: `${curve.method} ${p.samples} · ${seriesLabel(curve.key)}\nrelMSE ${number(p.error)}${p.is_resolved ? "" : " (limited by the reference)"}\n${slopeText(curve)}` })) })),
      ],
    }),
  });
}

/** The page of plots, of one run at a time. */
export function showPlots(view, state) {
  const run = model.runs[state.run] ? Number(state.run) : 0, own = pairs.filter((one) => one.run === run), groups = [];
  const isTimed = rows.some((row) => row.run === run && row.time), found = curveFacets(run), facets = found.length ? found : ["all"];
  const facet = facets.includes(state.facet) ? state.facet : facets[0], ownScenes = scenes.filter((one) => one.variants.some((row) => row.run === run));
  const scene = ownScenes.find((one) => one.key === state.scene) ?? ownScenes[0], lines = scene ? profileGroups(run, scene) : [];
  const again = (details) => { keep(details); redraw(view, () => showPlots(view, current())); };
  const pair = own.find((one) => `${one.sampled} ${one.fixed}` === state.pair) ?? own[0];
  const bar = h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Plots"),
    isJoined && select("Run", model.runs.map((one, i) => [i, one.label]), run, (value) => again({ run: value, facet: "", pair: "", scene: "" })),
    own.length > 1 && select("Methods", own.map((p) => [`${p.sampled} ${p.fixed}`, `${p.sampled} against ${p.fixed}`]), `${pair.sampled} ${pair.fixed}`, (value) => again({ pair: value })),
    facets.length > 1 && select("Show", facets.map((f) => [f, f]), facet, (value) => again({ facet: value })),
    ownScenes.length > 1 && select("Profile of", ownScenes.map((one) => [one.key, one.label]), scene.key, (value) => again({ scene: value })),
    lines.length > 1 && select("Profile lines", lines.map(({ name }) => [name, name]), state.lines ?? lines[0].name, (value) => again({ lines: value })),
    found.length > 0 && isTimed && [h("span", { class: "choice" }, "Time plot"), choice("Cells of the time plot", [["0", "This setting"], ["1", "All cells"]], state.all === "1" ? "1" : "0", (value) => again({ all: value }))]);
  if (isFurnace(run)) groups.push(energyFigure(run), sweepFigure(run, "alpha", ENERGY));
  groups.push(convergence(run, facet));
  groups.push(...effectAxes(run).map((axis) => effectsFigure(run, axis)), rangeFigure(run), timeError(run, state.all === "1" || !found.length ? "all" : facet));
  if (pair) groups.push(breakEvenMap(pair), equalTimeMap(pair), equalTimeIntervals(pair, facet), nDotVMap(pair, facet));
  if (scene) groups.push(profile(run, scene, state.lines));
  groups.push(visibility(run), passes(run, "frame"), passes(run, "precompute"), paybackTable(run));
  const links = model.figures.length > 0 && h("p", { class: "note" }, "Data and Vega-Lite specifications beside this report: ",
    model.figures.map((name, i) => [i ? ", " : "", h("a", { href: `${name.split("/").map(encodeURIComponent).join("/")}.vl.json` }, `${name.split("/").slice(1).join("/")}.vl.json`)]), ".");
  view.replaceChildren(bar, h("div", { class: "figures" }, groups.filter(Boolean)), links || "");
}
