// The cases of the analysis in words: which axes they have, how a case, a facet and a series are called, where they lead.

import { domain } from "report/chart";
import { model, short, symbol } from "report/data";
import { number } from "report/dom";
import { go } from "report/state";

export const { case_axes: caseAxes, curves, pairs } = model.analysis;
/** The case axis that colours tell apart: alpha, or else the last. */
export const seriesAxis = caseAxes.includes("alpha") ? caseAxes.indexOf("alpha") : caseAxes.length - 1;
export const facetAxes = caseAxes.map((_, i) => i).filter((i) => i !== seriesAxis);

const label = (axis, value) => { const text = short(caseAxes[axis], value); return /^[\d.e+-]+$/.test(text) ? `${symbol(caseAxes[axis])} ${text}` : text; };
export const facetLabel = (key) => facetAxes.map((i) => label(i, key[i])).filter(Boolean).join(" · ") || "all";
export const seriesLabel = (key) => (seriesAxis < 0 ? "" : `${symbol(caseAxes[seriesAxis])} ${short(caseAxes[seriesAxis], key[seriesAxis])}`);
export const keyLabel = (key) => key.map((value, i) => label(i, value)).filter(Boolean).join(" · ");
export const unique = (values) => [...new Set(values)];
/** What opens a cell's images. */
export const open = (cell, run) => () => go({ view: "compare", cell, run: run || undefined });
export const sampleAxis = (counts) => ({ label: "samples a pixel", log: true, domain: domain(counts, true), ticks: counts, format: (t) => String(t) });
export const curveFacets = unique(curves.map((curve) => facetLabel(curve.key)));
/** The methods without samples in a case, each with its error. */
export const fixedOf = (key) => unique(pairs.map((pair) => pair.fixed)).flatMap((fixed) => pairs.filter((pair) => pair.fixed === fixed).slice(0, 1)
  .flatMap((pair) => pair.cases.filter((c) => JSON.stringify(c.key) === JSON.stringify(key)).map((c) => ({ fixed, ...c }))));

export const breakEvenText = ({ n, above }) => (above ? `> ${n}` : `${n}`);

/** Ends of an interval of counts: JSON has no infinity, so an open end is null. */
export const ends = (interval) => interval && [interval[0], interval[1] ?? Infinity];

/** An interval of sample counts as people read it (answers::break_even::interval_text). */
export function intervalText(interval, counts) {
  if (!interval) return "no interval";
  const [lo, hi] = ends(interval), smallest = counts[0], largest = counts.at(-1), text = (n) => number(n, 2);
  if (lo === 0 && hi === Infinity) return "undecided";
  if (lo >= largest) return `never up to ${largest}`;
  if (hi <= smallest) return `always, from ${smallest}`;
  if (lo === 0) return `at most ${text(hi)}`;
  return hi === Infinity ? `${text(lo)} or more` : `${text(lo)} to ${text(hi)}`;
}

/** A count that may lie below or above those tried. */
export const countText = (n, counts) => (n === 0 ? `< ${counts[0]}` : n === null || n === Infinity ? `> ${counts.at(-1)}` : number(n, 2));
