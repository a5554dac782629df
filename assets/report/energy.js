// A white furnace: what is left of the light by angle, for each model and each way of masking.

import { open, runSuffix, runTitle, unique } from "report/cases";
import { SHAPES, domain, figure, ordinal, smallCharts } from "report/chart";
import { model, rows, sceneAxes, short, symbol, variantAxes, variantLabel } from "report/data";
import { number } from "report/dom";
import { ENERGY } from "report/effects";
import { binsOf } from "report/profile";

/** What the lines of a chart differ in. */
const SERIES = "alpha";

/**
 * Energy that leaves over energy that arrives, over n.v: a chart for each model and method, a line for each alpha. What lies above the line at 1
 * is created.
 */
export function energyFigure(run) {
  const own = rows.filter((row) => row.run === run && row.axes.method !== "none");
  const named = [...sceneAxes, ...variantAxes].filter((name) => ![SERIES, "run", "point_set"].includes(name) && unique(own.map((row) => row.axes[name])).length > 1);
  const isWay = (name) => name === "method" || name === "samples";
  const titleOf = (row) => [...named.filter((name) => !isWay(name)).map((name) => short(name, row.axes[name])), named.some(isWay) ? variantLabel(row, [...variantAxes].filter((name) => !isWay(name))) : ""].filter(Boolean).join(" · ");
  const lines = own.map((row) => ({ row, title: titleOf(row), bins: binsOf(row, ENERGY).map(([lo, hi, bias]) => [lo, hi, 1 + bias]).filter(([, , left]) => Number.isFinite(left)) })).filter(({ bins }) => bins.length);
  if (!lines.length) return null;
  const values = unique(lines.map(({ row }) => row.axes[SERIES])).sort((a, b) => a - b), titles = unique(lines.map(({ title }) => title));
  const all = lines.flatMap(({ bins }) => bins.map(([, , left]) => left)), [lo, hi] = domain([...all, 0, 1]);
  const style = (row) => { const i = values.indexOf(row.axes[SERIES]); return { color: ordinal(i, values.length), shape: SHAPES[i % SHAPES.length] }; };
  const middle = ([from, to]) => (from + Math.min(1, to)) / 2, last = named.filter((name) => !isWay(name)).at(-1);
  const perRow = last ? unique(lines.map(({ row }) => row.axes[last])).length : titles.length;
  const says = ([from, to, left], { row, title }) => `${[title, `${symbol(SERIES)} ${short(SERIES, row.axes[SERIES])}`].filter(Boolean).join(" · ")}\nn·v ${number(from)} to ${number(Math.min(1, to))}: ${number(100 * left, 4)} % leaves\n${left > 1 ? "created" : "lost"}: ${number(100 * Math.abs(left - 1))} %`;
  return figure({
    name: `energy-n-dot-v${runSuffix(run)}`,
    class: "lead-figure",
    title: `What is left of the light, by angle${runTitle(run)}`,
    note: "Energy that leaves over energy that arrives in a white furnace: left grazing, right facing the viewer. At 1 none is lost; in the tinted part energy is created. Click a mark for its image.",
    legend: values.map((value, i) => ({ label: `${symbol(SERIES)} ${short(SERIES, value)}`, color: ordinal(i, values.length), shape: SHAPES[i % SHAPES.length] })),
    table: { columns: [...named, SERIES, "n_dot_v_from", "n_dot_v_to", "albedo"], rows: lines.flatMap(({ row, bins }) => bins.map((bin) => [...named.map((name) => row.axes[name]), row.axes[SERIES], ...bin])),
      onrow: (i) => { const { row } = lines.flatMap((line) => line.bins.map(() => line))[i]; open(row.cell, run)(); } },
    ...smallCharts({
      perRow,
      x: { label: "n·v", domain: [0, 1], ticks: [0, 0.5, 1] },
      y: { label: "leaves / arrives", domain: [lo, hi], share: "energy-n-dot-v y" },
      all: titles.map((title) => {
        const inside = lines.filter((line) => line.title === title);
        return { title, marks: [
          { band: [[0, 1, hi], [1, 1, hi]], color: "var(--series-1)", opacity: 0.16 },
          { rule: 1, color: "var(--ink)", width: 1.3 },
          ...inside.map((line) => ({ line: line.bins.map((bin) => [middle(bin), bin[2]]), ...style(line.row), width: 1.6 })),
          ...inside.map((line) => ({ ...style(line.row), r: 2.6, dots: line.bins.map((bin) => ({ x: middle(bin), y: bin[2], open: open(line.row.cell, run), text: says(bin, line) })) })),
        ] };
      }),
    }),
  });
}

/** Whether a run is one of furnaces: its first chart says so. */
export const isFurnace = (run) => model.runs[run].lead.kind === "energy";
