// The cases of the analysis in words: which axes they have, how a case, a facet and a series are called, where they lead.

import { domain } from "report/chart";
import { model, short, symbol } from "report/data";
import { number } from "report/dom";
import { go } from "report/state";

/** Keys without the run: a pair of methods and a curve belong to one run each, and nothing is drawn over several. */
const runAt = model.analysis.case_axes.indexOf("run");
const withoutRun = (key) => key.filter((_, i) => i !== runAt);
export const caseAxes = withoutRun(model.analysis.case_axes);
export const curves = model.analysis.curves.map((curve) => ({ ...curve, run: curve.points[0].run, key: withoutRun(curve.key) }));
export const pairs = model.analysis.pairs.map((pair) => ({ ...pair, cases: pair.cases.map((c) => ({ ...c, key: withoutRun(c.key) })) }));
export const isJoined = model.runs.length > 1;
/** What tells the figures of one run from those of another: in a title, and in a file's name. */
export const runTitle = (run) => (isJoined ? ` · ${model.runs[run].label}` : "");
export const runSuffix = (run) => (isJoined ? `-run-${run + 1}` : "");
/** The case axis that colours tell apart: alpha, or else the last. */
export const seriesAxis = caseAxes.includes("alpha") ? caseAxes.indexOf("alpha") : caseAxes.length - 1;
export const facetAxes = caseAxes.map((_, i) => i).filter((i) => i !== seriesAxis);

const label = (axis, value) => { const text = short(caseAxes[axis], value); return /^[\d.e+-]+$/.test(text) ? `${symbol(caseAxes[axis])} ${text}` : text; };
export const facetLabel = (key) => facetAxes.map((i) => label(i, key[i])).filter(Boolean).join(" · ") || "all";
export const seriesLabel = (key) => (seriesAxis < 0 ? "" : `${symbol(caseAxes[seriesAxis])} ${short(caseAxes[seriesAxis], key[seriesAxis])}`);
export const keyLabel = (key) => key.map((value, i) => label(i, value)).filter(Boolean).join(" · ");
export const unique = (values) => [...new Set(values)];
/** Values by size where all are numbers, else as they come. */
export const ordered = (values) => (values.every((value) => Number.isFinite(Number(value))) ? [...values].sort((a, b) => a - b) : values);

/**
 * What groups of rows can be held against each other by: the rows of those places that every group has, {own, shared, total}. Where cells
 * failed, medians over all rows would stand for different scenes. Where no place has every group, all rows are left.
 */
export function sharedRows(rows, group, place) {
  const groups = new Set(rows.map(group)).size, found = new Map();
  for (const row of rows) found.set(place(row), (found.get(place(row)) ?? new Set()).add(group(row)));
  const isShared = (row) => found.get(place(row)).size === groups, own = rows.filter(isShared);
  return { own: own.length ? own : rows, shared: new Set(own.map(place)).size, total: found.size };
}
/** How many that are, in words, where they are not all. */
export const sharedText = ({ shared, total }, what) => (shared === total ? "" : shared ? ` Over ${shared} of ${total} ${what}: those that have a result for all that is shown.` : ` No ${what.replace(/s$/, "")} has a result for all that is shown: each mark stands for what it has.`);

/** What opens a cell's images. */
export const open = (cell, run) => () => go({ view: "compare", cell, run: run || undefined });
/** Sample counts; `share` names the charts of several runs that have one such axis. */
export const sampleAxis = (counts, share) => ({ label: "samples a pixel", log: true, domain: domain(counts, true), ticks: counts, format: (t) => String(t), share: share && `${share} x` });
export const curveFacets = (run) => unique(curves.filter((curve) => curve.run === run).map((curve) => facetLabel(curve.key)));
/** The methods without samples in a case, each with its error. */
export const fixedOf = (key, run) => unique(pairs.map((pair) => pair.fixed)).flatMap((fixed) => pairs.filter((pair) => pair.fixed === fixed && pair.run === run).slice(0, 1)
  .flatMap((pair) => pair.cases.filter((c) => JSON.stringify(c.key) === JSON.stringify(key)).map((c) => ({ fixed, ...c }))));

export const breakEvenText = ({ n, above }) => (above ? `> ${n}` : `${n}`);

/** Ends of an interval of counts, null without one: JSON has no infinity, so an open end is null. */
export const ends = (interval) => (interval && interval[0] !== null ? [interval[0], interval[1] ?? Infinity] : null);

/** An interval of sample counts as people read it (answers::break_even::interval_text). */
export function intervalText(interval, counts) {
  if (!ends(interval)) return "no interval";
  const [lo, hi] = ends(interval), smallest = counts[0], largest = counts.at(-1), text = (n) => number(n, 2);
  if (lo === 0 && hi === Infinity) return "undecided";
  if (lo >= largest) return `never up to ${largest}`;
  if (hi <= smallest) return `always, from ${smallest}`;
  if (lo === 0) return `at most ${text(hi)}`;
  return hi === Infinity ? `${text(lo)} or more` : `${text(lo)} to ${text(hi)}`;
}

/** A count that may lie below or above those tried. */
export const countText = (n, counts) => (n === 0 ? `< ${counts[0]}` : n === null || n === Infinity ? `> ${counts.at(-1)}` : number(n, 2));
