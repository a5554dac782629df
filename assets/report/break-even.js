// The figures of the break-even: at equal error, at equal time, over alpha, environment and n.v.

import { domain, figure, ordinal, xy } from "report/chart";
import { breakEvenText, caseAxes, countText, curves, ends, facetAxes, facetLabel, intervalText, keyLabel, open, ordered, runSuffix, runTitle, sampleAxis, seriesAxis, seriesLabel, unique } from "report/cases";
import { exclusionOf, headline, model, short, symbol } from "report/data";
import { heat } from "report/color";
import { number, quartiles } from "report/dom";
import { mapped } from "report/maps";

/** What a table says about a crossing, in the words of tables/break_even.csv. */
const CROSSING = ["break_even", "crossing", "crossing_lo", "crossing_hi", "interval_from", "at_equal_time"];
const crossingCells = (c) => [breakEvenText(c.break_even), c.crossing, ...(ends(c.interval) ?? [null, null]), c.basis === "none" ? null : c.basis, c.at_equal_time === "not-timed" ? null : c.at_equal_time];
const TIME = ["samples_in_equal_time", "samples_in_equal_time_lo", "samples_in_equal_time_hi"];
const timeCells = (c) => (c.time ? [c.time.samples ?? Infinity, ...(ends(c.time.interval) ?? [null, null])] : [null, null, null]);
const isTimed = (c) => c.time !== null && c.at_equal_time !== "not-timed";
const timeNote = (cases) => (cases.some((c) => c.time?.is_cpu) ? " Times of a CPU driver say nothing about a GPU." : "");
const winner = (pair, c) => ({ sampled: pair.sampled, fixed: pair.fixed, undecided: "undecided", "too-few-rounds": "too few rounds for an interval" })[c.at_equal_time];

/** A case in a few lines: break-even and crossing with intervals, at equal error and at equal time. */
function caseText(pair, c) {
  const { sample_counts: counts } = pair;
  const lines = [keyLabel(c.key), `at equal error: ${breakEvenText(c.break_even)} samples; crosses at ${c.crossing === null ? "none" : number(c.crossing, 2)} (95 %: ${intervalText(c.interval, counts)})`];
  if (isTimed(c)) lines.push(`in the time of ${pair.fixed}: ${countText(c.time.samples, counts)} samples (${ends(c.time.interval) ? `95 %: ${ends(c.time.interval).map((n) => countText(n, counts)).join(" to ")}` : "no interval"}); errs less: ${winner(pair, c)}`);
  return lines.join("\n");
}

/** Error of sampling over error of the fixed method, for every case: where it falls below 1, sampling wins. */
export function breakEvenChart(pair) {
  const counts = pair.sample_counts;
  const series = ordered(unique(pair.cases.map((c) => c.key[seriesAxis])));
  const ratios = pair.cases.map((c) => curves[c.curve].points.map((p) => [p.samples, p.error / c.fixed_error, p]));
  // Medians of one line are those of the same cases: of those that have every count.
  const whole = ratios.filter((line) => counts.every((n) => line.some(([m]) => m === n)));
  const middle = whole.length ? counts.map((n) => [n, quartiles(whole.flat().filter(([m]) => m === n).map(([, ratio]) => ratio))]) : [];
  const color = (c) => ordinal(series.indexOf(c.key[seriesAxis]), series.length);
  const crossings = pair.cases.filter((c) => c.crossing !== null);
  return figure({
    name: `break-even-curves${runSuffix(pair.run)}`,
    class: "lead-figure",
    height: (width, unit) => Math.round(Math.min(Math.max(260, (innerHeight / unit) * 0.56), width * 0.9)),
    title: `Error of ${pair.sampled} over error of ${pair.fixed}${runTitle(pair.run)}`,
    note: `One line a case; bold: the median, shaded: the middle half${whole.length < ratios.length ? `, over the ${whole.length} of ${ratios.length} cases that have every count` : ""}. Below 1, ${pair.sampled} is closer to the reference. Open marks on the line: where a case crosses.`,
    legend: [...series.map((value, i) => ({ label: seriesAxis < 0 ? "cases" : `${symbol(caseAxes[seriesAxis])} ${short(caseAxes[seriesAxis], value)}`, color: ordinal(i, series.length) })),
      ...(whole.length ? [{ label: "median", color: "var(--ink)" }] : [])],
    table: {
      columns: [...caseAxes, pair.fixed, ...counts.map((n) => `${pair.sampled} ${n}`), ...CROSSING, ...TIME],
      rows: pair.cases.map((c) => [...c.key, c.fixed_error, ...counts.map((n) => curves[c.curve].points.find((p) => p.samples === n)?.error ?? null), ...crossingCells(c), ...timeCells(c)]),
      onrow: (i) => open(pair.cases[i].fixed_cell, pair.cases[i].fixed_run)(),
    },
    draw: xy({
      x: sampleAxis(counts, "break-even-curves"),
      y: { label: `relMSE ratio ${pair.sampled} / ${pair.fixed}`, log: true, share: "break-even-curves y", domain: domain([...ratios.flat().map(([, ratio]) => ratio), 1], true) },
      marks: [
        { band: middle.map(([n, [lo, , hi]]) => [n, lo, hi]), color: "var(--ink)" },
        ...pair.cases.map((c, i) => ({ line: ratios[i].map(([n, ratio]) => [n, ratio]), color: color(c), width: 1.1, opacity: 0.75 })),
        { rule: 1, color: "var(--ink)", width: 1.4 },
        { text: `${pair.fixed} better ↑`, corner: "top", color: "var(--muted)" },
        { text: `${pair.sampled} better ↓`, corner: "bottom", color: "var(--muted)" },
        { line: middle.map(([n, [, m]]) => [n, m]), color: "var(--ink)", width: 3 },
        { r: 2.6, dots: pair.cases.flatMap((c, i) => ratios[i].map(([n, ratio, p]) => ({ x: n, y: ratio, color: color(c), open: open(p.cell, p.run),
          text: `${keyLabel(c.key)}\n${pair.sampled} ${n}: relMSE ${number(p.error)}\n${pair.fixed}: ${number(c.fixed_error)} · ratio ${number(ratio)}` }))) },
        { r: 3.6, dots: crossings.map((c) => ({ x: c.crossing, y: 1, color: "var(--paper)", open: open(c.fixed_cell, c.fixed_run), text: caseText(pair, c) })) },
      ],
    }),
  });
}

/** Colour and ink of a break-even count: dark is early. Every count tried has its own step of the ramp, and so has none of them. */
export function breakEvenColor(pair, { n, above }) {
  const { sample_counts: counts } = pair;
  return heat((above ? counts.length : counts.indexOf(n)) / Math.max(1, counts.length));
}

/** The legend of counts that occur, and of what is missing. */
function countLegend(pair, counts, missing) {
  const found = counts.map((one) => [one.above ? Infinity : one.n, one]).sort(([a], [b]) => a - b);
  const entries = [...new Map(found).values()].map((one) => ({ label: one.above ? `> ${one.n}: not reached by any count tried` : `from ${one.n}`, fill: breakEvenColor(pair, one).color }));
  return [...entries, ...missingLegend(missing)];
}

const missingLegend = (missing) => [
  ...(missing.some((one) => one.hatch) ? [{ label: "excluded by the experiment", hatch: true }] : []),
  ...(missing.some((one) => !one.hatch) ? [{ label: "no result: failed or not run", fill: "var(--faint)" }] : []),
];

/** Rows by the series axis, columns by all others, and what stands where there is no case. */
function casesGrid(pair) {
  // With what the experiment excludes, so that a column without any case is not missing from the map.
  const { axes, points } = model.exclusions;
  const { label: run } = model.runs[pair.run], isOwn = ([, values]) => !axes.includes("run") || values[axes.indexOf("run")] === run;
  const excluded = caseAxes.every((name) => axes.includes(name)) ? points.filter(isOwn).map(([, values]) => caseAxes.map((name) => values[axes.indexOf(name)])) : [];
  const keys = [...pair.cases.map((c) => c.key), ...excluded.filter((key) => key.every((value) => value !== ""))];
  const lines = ordered(unique(keys.map((key) => key[seriesAxis]))), facets = unique(keys.map(facetLabel));
  const at = (r, c) => pair.cases.find((one) => one.key[seriesAxis] === lines[r] && facetLabel(one.key) === facets[c]);
  const missing = (r, c) => {
    const key = [...keys.find((one) => facetLabel(one) === facets[c])];
    if (seriesAxis >= 0) key[seriesAxis] = lines[r];
    const wanted = Object.fromEntries(caseAxes.map((name, i) => [name, key[i]]));
    const why = [pair.sampled, pair.fixed].map((method) => exclusionOf({ ...wanted, run, method })).find((text) => text !== null);
    return why === undefined ? { text: "", title: `${keyLabel(key)}: no result, failed or not run` } : { hatch: true, text: "", title: `${keyLabel(key)}: excluded by the experiment: ${why}` };
  };
  const all = lines.flatMap((_, r) => facets.map((_, c) => [r, c]));
  return { lines, facets, at, missing, gaps: all.filter(([r, c]) => !at(r, c)).map(([r, c]) => missing(r, c)) };
}

const gridHeads = ({ lines, facets }) => ({
  rows: lines.map((value) => short(caseAxes[seriesAxis], value ?? "")), columns: facets,
  rowTitle: seriesAxis < 0 ? "" : symbol(caseAxes[seriesAxis]), columnTitle: facetAxes.map((i) => symbol(caseAxes[i])).join(" · "),
});

/** Break-even of every case at equal error. */
export function breakEvenMap(pair) {
  const grid = casesGrid(pair);
  return figure({
    name: `break-even${runSuffix(pair.run)}`,
    title: `Break-even of ${pair.sampled} with ${pair.fixed}${runTitle(pair.run)}`,
    note: "At equal error: the smallest tried sample count from which on every larger one is better too. Click a cell for its images.",
    legend: countLegend(pair, pair.cases.map((c) => c.break_even), grid.gaps),
    table: { columns: [...caseAxes, ...CROSSING], rows: pair.cases.map((c) => [...c.key, ...crossingCells(c)]), onrow: (i) => open(pair.cases[i].fixed_cell, pair.cases[i].fixed_run)() },
    ...mapped({
      ...gridHeads(grid),
      cell: (r, c) => {
        const one = grid.at(r, c);
        return one ? { text: breakEvenText(one.break_even), ...breakEvenColor(pair, one.break_even), open: open(one.fixed_cell, one.fixed_run), title: caseText(pair, one) } : grid.missing(r, c);
      },
    }),
  });
}

const WINNERS = { sampled: { color: "var(--series-0)", ink: "var(--on-series)" }, fixed: { color: "var(--series-1)", ink: "var(--on-series)" }, undecided: { color: "var(--undecided)", ink: "#000" }, "too-few-rounds": { color: "var(--undecided)", ink: "#000" } };

/** Who errs less in the frame time of the method without samples; null where nothing was timed. */
export function equalTimeMap(pair) {
  const timed = pair.cases.filter(isTimed);
  if (!timed.length) return null;
  const grid = casesGrid(pair), untimed = pair.cases.some((c) => !isTimed(c));
  return figure({
    name: `equal-time${runSuffix(pair.run)}`,
    title: `At equal frame time: ${pair.sampled} or ${pair.fixed}${runTitle(pair.run)}`,
    note: `Samples that fit into the time of ${pair.fixed} / samples that its error takes. Decided where their 95 % intervals do not meet.${timeNote(timed)}`,
    legend: [...["sampled", "fixed", "undecided"].map((key) => ({ label: key === "undecided" ? "undecided: the intervals meet, or too few rounds for one" : `${pair[key]} errs less`, fill: WINNERS[key].color })),
      ...(untimed ? [{ label: "not timed", fill: "var(--faint)" }] : []), ...missingLegend(grid.gaps)],
    table: { columns: [...caseAxes, ...TIME, ...CROSSING], rows: timed.map((c) => [...c.key, ...timeCells(c), ...crossingCells(c)]), onrow: (i) => open(timed[i].fixed_cell, timed[i].fixed_run)() },
    ...mapped({
      ...gridHeads(grid),
      cell: (r, c) => {
        const one = grid.at(r, c);
        if (!one) return grid.missing(r, c);
        if (!isTimed(one)) return { text: "", title: `${keyLabel(one.key)}: not timed` };
        const needed = one.crossing === null ? breakEvenText(one.break_even) : number(one.crossing, 2);
        return { text: `${countText(one.time.samples, pair.sample_counts)} / ${needed}`, ...WINNERS[one.at_equal_time], open: open(one.fixed_cell, one.fixed_run), title: caseText(pair, one) };
      },
    }),
  });
}

/** Both counts of every case of a facet with their intervals: what the error takes, and what the time allows. */
export function equalTimeIntervals(pair, facet) {
  const own = pair.cases.filter((c) => facetLabel(c.key) === facet && (ends(c.interval) || isTimed(c)));
  if (!own.length) return null;
  const counts = pair.sample_counts, timed = own.filter(isTimed), edge = [counts[0] / 1.6, counts.at(-1) * 1.6];
  const into = (n) => Math.min(edge[1], Math.max(edge[0], n));
  // What was not reached, and what was reached at once, has a mark of its own: its place is not known, only its side.
  const last = counts.at(-1), never = own.some((c) => c.break_even.above), always = own.some((c) => !c.break_even.above && c.crossing === null);
  const errorMark = (c) => (c.break_even.above ? { x: edge[1], dx: -7, shape: "beyond", r: 6 } : c.crossing === null ? { x: edge[0], dx: 7, shape: "before", r: 6 } : { x: into(c.crossing) });
  const timeMark = ({ samples: n }) => (n === null ? { x: edge[1], dx: -7, shape: "beyond", r: 6 } : n === 0 ? { x: edge[0], dx: 7, shape: "before", r: 6 } : { x: into(n) });
  const spread = 0.14;
  return figure({
    name: `equal-time-intervals-${facet}${runSuffix(pair.run)}`,
    title: `Break-even with 95 % intervals · ${facet}${runTitle(pair.run)}`,
    note: `Dots: samples from which ${pair.sampled} errs less than ${pair.fixed}. ${timed.length ? `Squares: samples that fit into the time of ${pair.fixed}; where a square lies right of its dot, ${pair.sampled} wins at equal time.` : "Nothing was timed."} Arrows at the edge: beyond the counts tried.${timeNote(timed)}`,
    height: () => 64 + 38 * own.length,
    legend: [{ label: "at equal error", color: "var(--series-0)", shape: "circle" }, ...(timed.length ? [{ label: "at equal time", color: "var(--series-1)", shape: "square" }] : []),
      ...(never ? [{ label: `never up to ${last}`, color: "var(--series-0)", shape: "beyond", line: false }] : []), ...(always ? [{ label: `always, from ${counts[0]}`, color: "var(--series-0)", shape: "before", line: false }] : [])],
    table: { columns: [...caseAxes, ...CROSSING, ...TIME], rows: own.map((c) => [...c.key, ...crossingCells(c), ...timeCells(c)]), onrow: (i) => open(own[i].fixed_cell, own[i].fixed_run)() },
    draw: xy({
      x: { ...sampleAxis(counts), domain: edge },
      y: { label: "", domain: [own.length - 0.5, -0.5], ticks: own.map((_, i) => i), format: (i) => seriesLabel(own[i].key) || facet },
      marks: [
        { color: "var(--series-0)", shape: "circle", r: 4.5, dots: own.map((c, i) => ({ ...errorMark(c), y: i - spread, xs: ends(c.interval), open: open(c.fixed_cell, c.fixed_run), text: caseText(pair, c) })) },
        { color: "var(--series-1)", shape: "square", r: 4.5, dots: own.flatMap((c, i) => (isTimed(c) ? [{ ...timeMark(c.time), y: i + spread, xs: ends(c.time.interval), open: open(c.fixed_cell, c.fixed_run), text: caseText(pair, c) }] : [])) },
      ],
    }),
  });
}

/** Break-even over alpha and n.v in one facet. */
export function nDotVMap(pair, facet) {
  const own = pair.cases.filter((c) => facetLabel(c.key) === facet && c.bins.length);
  if (!own.length) return null;
  const bins = unique(own.flatMap((c) => c.bins.map((bin) => bin.lo))).sort((a, b) => a - b);
  const hi = Object.fromEntries(own.flatMap((c) => c.bins.map((bin) => [bin.lo, bin.hi])));
  const all = own.flatMap((c) => c.bins.map((bin) => ({ c, bin })));
  const gaps = all.length < own.length * bins.length;
  return figure({
    name: `break-even-n-dot-v-${facet}${runSuffix(pair.run)}`,
    title: `Break-even over ${seriesAxis < 0 ? "cases" : symbol(caseAxes[seriesAxis])} and n·v · ${facet}${runTitle(pair.run)}`,
    note: `Samples from which on ${pair.sampled} beats ${pair.fixed}, over the pixels of each bin of n·v: left grazing, right facing the viewer.`,
    legend: [...countLegend(pair, all.map(({ bin }) => bin.break_even), []), ...(gaps ? [{ label: "no pixels", fill: "var(--faint)" }] : [])],
    table: { columns: [...caseAxes, "n_dot_v_from", "n_dot_v_to", `${pair.fixed} ${headline}`, ...CROSSING], rows: all.map(({ c, bin }) => [...c.key, bin.lo, bin.hi, bin.fixed_error, ...crossingCells(bin)]),
      onrow: (i) => { const { c } = all[i]; open(c.fixed_cell, c.fixed_run)(); } },
    ...mapped({
      rows: own.map((c) => short(caseAxes[seriesAxis] ?? "", c.key[seriesAxis] ?? "")), columns: bins.map((lo) => `${number(lo, 2)}–${number(hi[lo], 2)}`), rowTitle: seriesAxis < 0 ? "" : symbol(caseAxes[seriesAxis]), columnTitle: "n·v",
      cell: (r, c) => {
        const bin = own[r].bins.find((one) => one.lo === bins[c]);
        if (!bin) return { text: "", title: `${keyLabel(own[r].key)}, n·v from ${bins[c]}: no pixels` };
        return { text: breakEvenText(bin.break_even), ...breakEvenColor(pair, bin.break_even), open: open(own[r].fixed_cell, own[r].fixed_run),
          title: `${keyLabel(own[r].key)}, n·v ${bin.lo} to ${bin.hi}: ${breakEvenText(bin.break_even)} samples (95 %: ${intervalText(bin.interval, pair.sample_counts)}); ${pair.fixed} ${number(bin.fixed_error)}` };
      },
    }),
  });
}
