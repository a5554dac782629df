// The first screen: the chart that answers the question of each run, further ones below, and images to see it by.

import { breakEvenChart, breakEvenMap, equalTimeMap } from "report/break-even";
import { isJoined, pairs, runTitle, unique } from "report/cases";
import { hasPixels, headline, idOf, model, scenes, truthName, variantAxes, variantLabel } from "report/data";
import { byId, h, soft } from "report/dom";
import { ENERGY, effectAxes, effectsFigure, rangeFigure, sweepFigure } from "report/effects";
import { energyFigure } from "report/energy";
import { settingsOf, thumbnail } from "report/grid";
import { convergence } from "report/plots";
import { profile } from "report/profile";
import { link } from "report/state";
import { passes, paybackTable, timeError } from "report/times";
import { visibility } from "report/visibility";

const pairOf = (run) => pairs.find((pair) => pair.run === run);
const maps = (run) => { const pair = pairOf(run); return pair ? [breakEvenMap(pair), equalTimeMap(pair)] : []; };

/** Axes that choose an estimator are answered before a parameter of one, as in the sentence. */
const estimatorsBefore = (run) => { const { kind, axis } = model.runs[run].lead; return kind === "effects" ? effectAxes(run).filter((name) => ["method", "diffuse"].includes(name) && name !== axis) : []; };

/** The figures of a run, the one that answers its question first. */
function figures(run) {
  const { kind, axis } = model.runs[run].lead;
  const made = {
    "visibility": () => [visibility(run), convergence(run), ...maps(run)],
    "energy": () => [energyFigure(run), sweepFigure(run, "alpha", ENERGY)],
    "range": () => [rangeFigure(run), ...maps(run)],
    "break-even": () => [breakEvenChart(pairOf(run)), ...maps(run)],
    "times": () => [passes(run, "frame"), passes(run, "precompute"), paybackTable(run), timeError(run, "all")],
    "effects": () => [...estimatorsBefore(run), axis, ...effectAxes(run).filter((name) => name !== axis && !estimatorsBefore(run).includes(name)).slice(0, 3)].map((name) => effectsFigure(run, name)),
    "convergence": () => [convergence(run)],
    "sweep": () => [sweepFigure(run, axis)],
    "profile": () => [profile(run, scenes[0])],
  }[kind]();
  return made.filter(Boolean);
}

/** How many figures stand beside the answer: what a frame costs and what the tables cost are one answer. */
const beside = (run) => (model.runs[run].lead.kind === "times" ? 3 : 1 + estimatorsBefore(run).length);

let theme = null;
/** Charts and a sample of the images below the sentence, which stands in the page already. Made anew when the theme changes. */
export function showAnswer() {
  const now = matchMedia("(prefers-color-scheme: dark)").matches;
  if (theme === now) return;
  theme = now;
  const all = model.runs.map((_, run) => figures(run));
  byId("lead-chart").replaceChildren(...all.flatMap((own, run) => {
    const first = own.slice(0, beside(run));
    return isJoined ? [h("section", { "data-run": run }, first)] : first;
  }));
  byId("answer-rest").replaceChildren(...all.map((own, run) => h("div", { class: "two", "data-run": run }, own.slice(beside(run)), strip(run))));
}

/**
 * Images of a scene that differ in one thing alone: `axis`. Of several groups of such images the one with most of them; then that with the
 * largest sample count.
 */
function alike(own, axis) {
  const others = variantAxes.filter((name) => name !== axis && name !== "run");
  // A method that draws no samples, or has no such parameter, fits any group.
  const fits = (row, group) => others.every((name) => row.axes[name] === group.axes[name] || row.axes[name] === "");
  const groups = own.map((group) => {
    const found = new Map(own.filter((row) => fits(row, group)).map((row) => [row.axes[axis] || variantLabel(row), row]));
    return { found: [...found.values()], samples: Number(group.axes.samples) || 0, set: Number(group.axes.point_set) || 0 };
  });
  groups.sort((a, b) => b.found.length - a.found.length || b.samples - a.samples || a.set - b.set);
  return groups[0].found;
}

/** The variants of a run in a scene that have pixels, and of several point sets the first. */
function shownOf(run, scene) {
  const own = scene.variants.filter((row) => row.run === run && hasPixels(row) && row.axes.method !== "none"), seen = new Set();
  const shown = own.length ? own : scene.variants.filter((row) => row.run === run && hasPixels(row));
  return shown.filter((row) => { const way = variantLabel(row, ["point_set", "run"]); return !seen.has(way) && seen.add(way); });
}

/** What a run's images are chosen to show: {scene, chosen, note}. */
function choose(run, withPixels) {
  const pair = pairOf(run), { kind, axis } = model.runs[run].lead;
  if (pair && kind === "break-even") {
    const cases = [...pair.cases].sort((a, b) => (a.crossing ?? Infinity) - (b.crossing ?? Infinity)), middle = cases[Math.floor((cases.length - 1) / 2)];
    const isIt = (row) => row.run === run && row.cell === middle.fixed_cell;
    const scene = withPixels.find((one) => one.variants.some(isIt)) ?? withPixels[0], own = shownOf(run, scene);
    const sampled = own.filter((row) => row.axes.method === pair.sampled).sort((a, b) => a.axes.samples - b.axes.samples);
    const at = sampled.find((row) => Number(row.axes.samples) === middle.break_even.n) ?? sampled.at(-1);
    return { scene, chosen: unique([own.find(isIt) ?? own.find((row) => row.axes.method === pair.fixed), sampled[0], at].filter(Boolean)), note: "The scene whose break-even lies in the middle; the fewest samples, and those that break even." };
  }
  // Of scenes with one image each the one that errs most.
  const worst = (one) => Math.max(...shownOf(run, one).map((row) => row.scores[headline] ?? 0));
  const scene = ["energy", "sweep"].includes(kind) ? withPixels.reduce((best, one) => (worst(one) > worst(best) ? one : best)) : withPixels[0], own = shownOf(run, scene), differ = kind === "effects" && variantAxes.includes(axis) ? axis : variantAxes.includes("method") ? "method" : variantAxes.find((name) => name !== "run");
  const ranked = (differ ? alike(own, differ) : own).sort((a, b) => a.scores[headline] - b.scores[headline]);
  return { scene, chosen: unique([ranked.at(-1), ranked[ranked.length >> 1], ranked[0]].filter(Boolean)), note: ranked.length > 1 ? `The largest, the middle and the lowest error of images that differ in ${differ} alone.` : "The only image of its scene." };
}

/** The images of one telling scene. */
function strip(run) {
  const withPixels = scenes.filter((scene) => shownOf(run, scene).length);
  if (!withPixels.length) return h("p", { class: "note" }, model.image_notes.join(" "));
  const { scene, chosen, note } = choose(run, withPixels), own = scene.variants.find((row) => row.run === run && row.reference === scene.main.reference) ?? chosen[0], settings = settingsOf(own);
  const label = (row) => variantLabel(row, ["run", "point_set"]);
  return h("figure", { class: "figure strip" }, h("figcaption", {}, h("h2", {}, `See it: ${scene.label}${runTitle(run)}`)),
    h("p", { class: "note" }, `${note} Above the images, below their relative error (magma, 10⁻³ to 1). Click to compare them pixel by pixel.`),
    h("div", { class: "strip-images" }, h("div", {}, h("h3", {}, truthName), thumbnail(own, "image", settings, { isReference: true })),
      chosen.map((row) => h("div", { "data-shown": row.cell }, h("h3", {}, soft(label(row))), thumbnail(row, "image", settings), thumbnail(row, "error", settings)))),
    h("p", {}, h("a", { href: "#images" }, scenes.length === 1 ? "All images of the scene" : `All ${scenes.length} scenes`), " · ",
      h("a", { href: link({ view: "compare", cell: chosen[0].cell, run: run || undefined, split: 0.5 }) }, `Compare ${label(chosen[0])} with the ${truthName}`),
      chosen.length > 1 && [" · ", h("a", { href: link({ view: "compare", cell: chosen[0].cell, run: run || undefined, with: idOf(chosen.at(-1)), split: 0.5 }) }, `with ${label(chosen.at(-1))}`)]));
}
