// Error over n.v, cell by cell.

import { open, runSuffix, runTitle, unique } from "report/cases";
import { COLORS, SHAPES, domain, figure, ordinal, xy } from "report/chart";
import { axisOf, headline, model, table, variantAxes, variantLabel } from "report/data";
import { number, quartiles } from "report/dom";

const binRows = new Map();
/** A metric of a cell by n.v: [from, to, value] for each bin. */
export function binsOf(row, metric = headline) {
  if (!binRows.has(metric)) binRows.set(metric, model.runs.map((_, run) => {
    const found = new Map(), own = table(run, "errors_by_n_dot_v.csv");
    if (!own) return found;
    const [cell, lo, hi, value] = ["cell", "n_dot_v_from", "n_dot_v_to", metric].map((name) => own.columns.indexOf(name));
    for (const fields of own.rows) {
      if (!found.has(fields[cell])) found.set(fields[cell], []);
      found.get(fields[cell]).push([Number(fields[lo]), Number(fields[hi]), fields[value] === "" ? NaN : Number(fields[value])]);
    }
    return found;
  }));
  return binRows.get(metric)[row.run].get(row.cell) ?? [];
}

/** One line for each way in which a run makes a scene's image: the median over its point sets. */
function profileLines(run, scene) {
  const groups = new Map();
  for (const row of scene.variants.filter((one) => one.run === run)) {
    const bins = binsOf(row), name = variantLabel(row, ["point_set", "run"]);
    if (bins.length) groups.set(name, [...(groups.get(name) ?? []), { row, bins }]);
  }
  return [...groups].map(([name, members]) => ({ name, row: members[0].row, count: members.length,
    bins: members[0].bins.map(([lo, hi]) => [lo, hi, quartiles(members.flatMap(({ bins }) => bins.filter((bin) => bin[0] === lo).map((bin) => bin[2])))[1]]) }));
}

/** More lines than this cannot be told apart. */
const PROFILE_LINES = 7;

/** Groups of lines that differ in one axis alone, largest first; one group of all where they are few. {name, lines}. */
export function profileGroups(run, scene) {
  const all = profileLines(run, scene);
  if (all.length <= PROFILE_LINES) return [{ name: "all", lines: all, of: all.length }];
  // The axis with most values is what a group varies; the rest names it.
  const [varied] = variantAxes.filter((name) => !["run", "point_set"].includes(name)).sort((a, b) => axisOf[b].values.length - axisOf[a].values.length);
  const nameOf = ({ row }) => variantLabel(row, ["point_set", "run", varied]) || row.axes.method;
  // Methods that have neither samples nor what is varied are what the others are compared with: they stand first in every group.
  const fixed = all.filter(({ row }) => row.axes.samples === "" && row.axes[varied] === "").slice(0, 3), others = all.filter((one) => !fixed.includes(one));
  const groups = unique(others.map(nameOf)).map((name) => ({ name, lines: others.filter((one) => nameOf(one) === name), of: all.length, fixed: fixed.length }));
  // Where a group is still too large, values at even steps, with both ends.
  const most = PROFILE_LINES - fixed.length;
  const thin = (lines) => (lines.length <= most ? lines : unique(Array.from({ length: most }, (_, i) => lines[Math.round((i / (most - 1)) * (lines.length - 1))])));
  const place = ({ row }) => Number(row.axes[varied]) || 0;
  groups.sort((a, b) => b.lines.length - a.lines.length);
  return groups.map((group) => ({ ...group, lines: [...fixed, ...thin(group.lines.sort((a, b) => place(a) - place(b)))] }));
}

/** Error over n.v of one scene: a few lines that can be told apart. */
export function profile(run, scene, wanted) {
  const groups = profileGroups(run, scene), group = groups.find((one) => one.name === wanted) ?? groups[0], own = group.lines;
  if (!own.length) return null;
  const { fixed = 0 } = group, ramp = own.length - fixed;
  const colorOf = (i) => (i < fixed ? ["var(--ink)", ...COLORS.slice(1)][i] : ramp > 3 ? ordinal(i - fixed, ramp) : COLORS[i]);
  const style = (i) => ({ color: colorOf(i), shape: SHAPES[i % SHAPES.length], width: 2, dash: own[i].row.axes.samples === "" ? "7 3" : undefined });
  const middle = ([lo, hi]) => (lo + hi) / 2;
  return figure({
    name: `n-dot-v-${scene.label}${runSuffix(run)}`,
    title: `Error over n·v · ${scene.label}${runTitle(run)}`,
    note: `relMSE over the pixels of each bin: left grazing, right facing the viewer.${own.length < group.of ? ` ${own.length} of ${group.of} ways to make the image: ${fixed ? "those without samples, and others" : "those"} that differ in one thing alone; the others by “Profile lines”.` : ""}${own.some((one) => one.count > 1) ? " Of several point sets the median." : ""}`,
    legend: own.map((one, i) => ({ label: one.name, ...style(i) })),
    table: { columns: ["variant", "n_dot_v_from", "n_dot_v_to", headline], rows: own.flatMap(({ name, bins }) => bins.map((bin) => [name, ...bin])), onrow: (i) => { const { row } = own.flatMap((one) => one.bins.map(() => one))[i]; open(row.cell, row.run)(); } },
    draw: xy({
      x: { label: "n·v", domain: [0, 1] },
      y: { label: "relMSE", log: true, share: `n-dot-v-${scene.key} y`, domain: domain(own.flatMap(({ bins }) => bins.map((bin) => bin[2])), true) },
      marks: [
        ...own.map((one, i) => ({ line: one.bins.map((bin) => [middle(bin), bin[2]]), ...style(i) })),
        ...own.map((one, i) => ({ ...style(i), dots: one.bins.map((bin) => ({ x: middle(bin), y: bin[2], open: open(one.row.cell, one.row.run), text: `${one.name}\nn·v ${bin[0]} to ${bin[1]}: relMSE ${number(bin[2])}` })) })),
      ],
    }),
  });
}
