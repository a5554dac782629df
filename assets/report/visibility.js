// What the tone curve shows of an error and what it hides: a map over exposure and contrast for each method.

import { runSuffix, runTitle, sharedRows, sharedText, unique } from "report/cases";
import { figure } from "report/chart";
import { heat } from "report/color";
import { displayAxes, model, rows, variantLabel } from "report/data";
import { number, quartiles } from "report/dom";
import { panels, panelsHeight } from "report/maps";
import { go } from "report/state";

const numbers = (own, name) => unique(own.map((row) => row.axes[name])).sort((a, b) => a - b);

/**
 * The panels of a run. Where every way to make the image was seen at every exposure and contrast, each has a map of them; else a method has a
 * map of its sample counts over the settings that were tried.
 */
function layout(own) {
  const way = (row) => variantLabel(row, ["point_set", "run"]), ways = unique(own.map(way));
  const [contrasts, exposures] = ["contrast", "exposure"].map((name) => numbers(own, name));
  const setting = (row) => `${row.axes.contrast} ${row.axes.exposure}`;
  const isFull = contrasts.length > 1 && exposures.length > 1 && ways.every((name) => unique(own.filter((row) => way(row) === name).map(setting)).length === contrasts.length * exposures.length);
  if (isFull) {
    return ways.map((name) => ({ title: name, rows: contrasts, columns: exposures, rowTitle: "contrast", columnTitle: "exposure",
      of: (r, c) => own.filter((row) => way(row) === name && row.axes.contrast === contrasts[r] && row.axes.exposure === exposures[c]) }));
  }
  const settings = unique(own.map(setting)).map((text) => text.split(" ")).sort(([a, b], [c, d]) => a - c || b - d);
  // 1 is the curve as it is, and goes without saying beside another value.
  const label = ([contrast, exposure]) => [contrast === "1" ? "" : `c ${contrast}`, exposure === "1" ? "" : `e ${exposure}`].filter(Boolean).join(" · ") || "1";
  const methodOf = (row) => variantLabel(row, ["point_set", "run", "samples"]);
  return unique(own.map(methodOf)).map((name) => {
    const counts = numbers(own.filter((row) => methodOf(row) === name), "samples");
    return { title: name, rows: counts.map((count) => count || "–"), columns: settings.map(label), rowTitle: counts.some(Boolean) ? "samples" : "", columnTitle: "contrast (c) and exposure (e), else 1",
      of: (r, c) => own.filter((row) => methodOf(row) === name && row.axes.samples === counts[r] && row.axes.contrast === settings[c][0] && row.axes.exposure === settings[c][1]) };
  });
}

/** A value with as many digits as it takes to say on which side of the threshold it lies. */
export function flipText(flip, from) {
  let digits = Math.abs(flip - from) < 0.005 ? 3 : 2;
  while (digits < 8 && Number(flip.toFixed(digits)) >= from !== flip >= from) digits++;
  return flip.toFixed(digits);
}

/** The visible difference (FLIP) of a run by exposure and contrast; null where the tone curve was not varied. */
export function visibility(run) {
  const scored = rows.filter((row) => row.run === run && row.scores.flip !== null && row.scores.flip !== undefined);
  if (!displayAxes.length || !scored.length) return null;
  const common = sharedRows(scored, (row) => [variantLabel(row, ["point_set", "run"]), ...displayAxes.map((name) => row.axes[name])].join(" "), (row) => row.scene.key), { own } = common, from = model.visible_from;
  // What has no specular term is what the others stand on: it comes last.
  own.sort((a, b) => (a.axes.method === "none") - (b.axes.method === "none"));
  const all = layout(own), median = (of) => quartiles(of.map((row) => row.scores.flip))[1];
  const places = all.flatMap((panel) => panel.rows.flatMap((_, r) => panel.columns.map((_, c) => panel.of(r, c)))).filter((found) => found.length);
  // The ramp ends where what is shown does.
  const largest = Math.max(...places.map(median));
  const open = (row) => () => go({ view: "compare", cell: row.cell, run: row.run || undefined });
  const maps = all.map(({ of, ...panel }) => ({ ...panel, cell: (r, c) => {
    const found = of(r, c), flip = median(found), name = `${panel.title} ${panel.rowTitle} ${panel.rows[r]}, ${panel.columnTitle} ${panel.columns[c]}`;
    if (!Number.isFinite(flip)) return { text: "", title: `${name}: no result` };
    return { text: flipText(flip, from), ...(flip >= from ? heat(flip / largest) : { color: "var(--paper)", ink: "var(--muted)" }), open: open(found[0]), title: `${name}: FLIP ${number(flip)}, ${flip >= from ? "visible" : "hidden"}` };
  } }));
  return figure({
    name: `visibility${runSuffix(run)}`,
    class: "wide",
    title: `Visible difference (FLIP) by exposure and contrast${runTitle(run)}`,
    note: `Median over all scenes; 0 is equal.${sharedText(common, "scenes")} Coloured: at least ${from}, taken as visible; the tone curve hides the rest. The cells of a row share one linear image. Click for the image at that setting.`,
    legend: [{ label: `hidden: below ${from}`, fill: "var(--paper)" }, ...[from, (from + largest) / 2, largest].filter((flip) => flip >= from && flip <= largest).map((flip) => ({ label: `FLIP ${number(flip, 2)}`, fill: heat(flip / largest).color }))],
    height: (width) => panelsHeight(maps, width),
    table: { columns: ["variant", ...displayAxes, "flip", "cells", "visibility"], rows: places.map((found) => [variantLabel(found[0], ["point_set", "run"]), ...displayAxes.map((name) => found[0].axes[name]), median(found), found.length, median(found) >= from ? "visible" : "hidden"]),
      onrow: (i) => open(places[i][0])() },
    draw: panels(maps),
  });
}
