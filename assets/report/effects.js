// Error over what an experiment varies: a parameter of a method, a property of the scene, the peaks of the light.

import { open, runSuffix, runTitle, sharedRows, sharedText, unique } from "report/cases";
import { COLORS, DASHES, SHAPES, domain, figure, ordinal, xy } from "report/chart";
import { axisOf, headline, model, preset, rows, sceneAxes, short, symbol, variantAxes, variantLabel } from "report/data";
import { number } from "report/dom";

const isNumber = (text) => text !== "" && Number.isFinite(Number(text));
/** Values further apart than this stand on a logarithmic axis. */
const LOG_SPAN = 16;

/** The texels of a size as tables have it, "256x128"; NaN of anything else. */
const texels = (text) => (/^\d+x\d+$/.test(text) ? text.split("x").reduce((all, side) => all * side, 1) : NaN);
/** Whether the values of an axis have an order of their own. */
const areOrdered = (values) => values.every(isNumber) || values.every((value) => texels(value) > 0);

/** Places for the values of an axis: numbers where they lie, sizes by size and names as they come side by side. */
function scaleOf(axis, given) {
  if (given.every(isNumber)) {
    const sorted = [...given].sort((a, b) => a - b), all = sorted.map(Number), log = all[0] > 0 && all.at(-1) / all[0] >= LOG_SPAN;
    const [lo, hi] = [all[0], all.at(-1)], margin = (hi - lo) * 0.04 || 0.5;
    return { values: sorted, place: Number, x: { log, domain: log ? domain(all, true) : [lo - margin, hi + margin], ticks: all, format: (t) => number(t, 4) } };
  }
  const values = areOrdered(given) ? [...given].sort((a, b) => texels(a) - texels(b)) : given;
  return { values, place: (value) => values.indexOf(value), x: { domain: [-0.4, values.length - 0.6], ticks: values.map((_, i) => i), format: (i) => short(axis, values[i]), staggers: true } };
}

/** A place before the first value of an axis, for all of them together: {at, x: the axis with it}. */
function before({ log, domain: [lo, hi], ticks, format, ...rest }) {
  const [first, last] = [ticks[0], ticks.at(-1)], at = log ? first * (first / last) ** 0.16 : first - 0.16 * (last - first);
  return { at, x: { ...rest, log, domain: [log ? at * (first / last) ** 0.06 : at - 0.06 * (last - first), hi], ticks: [at, ...ticks], format: (t) => (t === at ? "all" : format(t)) } };
}

const style = (i, count) => ({ color: count > 7 ? ordinal(i, count) : COLORS[i], shape: SHAPES[i % SHAPES.length], dash: count > 7 ? DASHES[i % DASHES.length] : undefined });

/** A value with its axis: "bias 1.151 (materialx)"; one that says what it is stands alone. */
const named = (axis, value) => [isNumber(value) ? symbol(axis) : "", short(axis, value), preset(axis, value) && `(${preset(axis, value)})`].filter(Boolean).join(" ");

/** A chart with more pairs than this shows their means alone. */
const PAIR_MARKS = 30;
/** Names of more pairs than this would cover each other. */
const NAMED_PAIRS = 6;

/** Axes whose effects are known in a run, those with most values first. */
export function effectAxes(run) {
  const { effects } = model.runs[run], count = (axis) => effects.filter((e) => e.axis === axis && e.alpha === null).length;
  return unique(effects.map((e) => e.axis)).sort((a, b) => count(b) - count(a));
}

/** The first cell with this value of an axis in this method. */
function cellOf(run, axis, value, method) {
  const own = rows.filter((row) => row.run === run && row.axes[axis] === value);
  return own.find((row) => `${row.axes.method} ${row.axes.samples}`.trim() === method || row.axes.samples === method) ?? own[0];
}

/**
 * Error over the values of a parameter, as ratio to its first value, pair by pair of cells that differ in nothing else; with 95 % intervals.
 * A comparison of two values stands over alpha, where that is swept.
 */
export function effectsFigure(run, axis) {
  const all = model.runs[run].effects.filter((e) => e.axis === axis), whole = all.filter((e) => e.alpha === null);
  if (!whole.length) return null;
  // The values of every run: charts of joined runs have one axis.
  const others = model.runs.flatMap((one) => one.effects.filter((e) => e.axis === axis));
  const [{ base }] = whole, values = (axisOf[axis]?.values ?? []).filter((value) => value === base || others.some((e) => e.value === value || e.base === value));
  const overAlpha = values.length < 3 && all.some((e) => e.alpha !== null);
  const shown = overAlpha ? all.filter((e) => e.alpha !== null) : whole;
  const lineOf = (e) => (overAlpha ? [short(axis, e.value), e.method] : [e.method]).filter(Boolean).join(axis === "method" ? " · samples " : " · ");
  const name = (line) => (axis === "method" && !overAlpha ? `at ${line} samples` : line) || symbol(axis);
  const lines = unique(shown.map(lineOf)), { place, x } = overAlpha ? scaleOf("alpha", unique(others.flatMap((e) => e.alpha ?? []))) : scaleOf(axis, values);
  // All alphas together, which the answer states, stand before the first of them.
  const pooled = overAlpha && x.ticks.length > 1 ? before(x) : null;
  const at = (e) => place(overAlpha ? e.alpha : e.value), known = (e) => (e.interval[1] === null ? undefined : e.interval), isDecided = (e) => known(e) && (e.interval[0] > 1 || e.interval[1] < 1);
  const series = lines.map((line, i) => ({ line, i, own: shown.filter((e) => lineOf(e) === line).sort((a, b) => at(a) - at(b)) }));
  const curve = ({ own }) => [...own.map((e) => [at(e), e.ratio]), ...(overAlpha ? [] : [[place(base), 1]])].sort(([a], [b]) => a - b);
  const isOrdered = overAlpha || areOrdered(values), dx = (i) => (i - (lines.length - 1) / 2) * (isOrdered ? 3 : 9);
  const text = (e) => `${named(axis, e.value)} instead of ${short(axis, base)}${e.alpha === null ? "" : ` · α ${e.alpha}`}${e.method ? ` · ${e.method}` : ""}\nerror × ${number(e.ratio)}${known(e) ? ` (95 %: ${number(e.interval[0])} to ${number(e.interval[1])})` : ", one pair, no interval"}\nbetter in ${e.better} of ${e.n} ${e.n === 1 ? "pair" : "pairs"}`;
  // Of few pairs each has a mark of its own: which of them are better tells more than their mean.
  const few = !overAlpha && shown.flatMap((e) => e.pairs).length <= PAIR_MARKS ? shown.filter((e) => e.pairs.length > 1) : [], isNamed = lines.length === 1 && few.every((e) => e.pairs.length <= NAMED_PAIRS);
  const names = values.filter((value) => preset(axis, value) && value !== base), hasNames = names.length > 0;
  // On the side where there is room for their names.
  const side = (e) => (x.ticks.indexOf(at(e)) >= x.ticks.length / 2 ? -1 : 1);
  // An interval of two pairs can span a hundred decades; the axis does not follow it, and the whisker leaves the picture.
  const drawn = pooled ? [...shown, ...whole] : shown, near = domain([...drawn.map((e) => e.ratio), ...few.flatMap((e) => e.pairs.map((pair) => pair.ratio)), 1], true);
  const seen = drawn.flatMap((e) => known(e) ?? []).filter((end) => end > near[0] / 30 && end < near[1] * 30);
  return figure({
    name: `effects-${axis}${runSuffix(run)}`,
    class: "lead-figure",
    title: `${overAlpha ? `${named(axis, values.at(-1))} instead of ${short(axis, base)}` : `Error over ${symbol(axis)}`}${runTitle(run)}`,
    note: `relMSE over that with ${named(axis, base)}: the geometric mean over pairs of cells that differ in nothing else, with its 95 % interval. Below 1 errs less. Pale: the interval does not tell.${hasNames && !overAlpha ? ` Values of engines: ${names.map((value) => `${preset(axis, value)} ${short(axis, value)}`).join(", ")}.` : ""}${few.length ? ` Small marks: each pair${isNamed ? ", by name" : ""}.` : ""}${pooled ? " Left: all α together." : ""}${drawn.some((e) => (known(e) ?? []).some((end) => !seen.includes(end))) ? " Arrows at the frame: the interval goes on." : ""}`,
    legend: series.length > 1 || lines[0] ? series.map(({ line, i }) => ({ label: name(line), ...style(i, lines.length) })) : [],
    table: { columns: ["axis", "value", ...(hasNames ? ["preset"] : []), "base", "method", "alpha", "error_ratio", "ratio_lo", "ratio_hi", "pairs", "pairs_better"], rows: all.map((e) => [axis, e.value, ...(hasNames ? [preset(axis, e.value)] : []), base, e.method, e.alpha, e.ratio, e.interval[0], e.interval[1] ?? Infinity, e.n, e.better]),
      onrow: (i) => { const cell = cellOf(run, axis, all[i].value, all[i].method); open(cell.cell, run)(); } },
    draw: xy({
      x: { ...(pooled?.x ?? x), label: overAlpha ? "α" : symbol(axis) },
      y: { label: `relMSE ratio to ${named(axis, base)}`, log: true, share: `effects-${axis} ${base} y`, domain: domain([...near, ...seen], true) },
      marks: [
        { rule: 1, color: "var(--ink)", width: 1.2, label: overAlpha ? "no difference" : named(axis, base), below: true, isLeft: few.length > 0 },
        ...(isOrdered ? series.map((one) => ({ line: curve(one), ...style(one.i, lines.length), width: 2 })) : []),
        ...series.map(({ own, i }) => ({ ...style(i, lines.length), shape: "circle", r: 3, dots: own.filter((e) => few.includes(e)).flatMap((e) => e.pairs.map((pair) => {
          const cell = cellOf(run, axis, e.value, e.method);
          return { x: at(e), y: pair.ratio, dx: dx(i) + 16 * side(e), open: open(cell.cell, run), text: `${pair.label}\nerror × ${number(pair.ratio)}: ${symbol(axis)} ${short(axis, pair.ratio < 1 ? e.value : base)} errs less` };
        })) })),
        ...(isNamed ? few.map((e) => ({ dx: 26 * side(e), color: "var(--muted)", labels: e.pairs.map((pair) => ({ x: at(e), y: pair.ratio, text: pair.label })) })) : []),
        ...series.map(({ own, i }) => ({ ...style(i, lines.length), r: 4.5, dots: own.map((e) => {
          const cell = cellOf(run, axis, e.value, e.method);
          return { x: at(e), y: e.ratio, dx: dx(i), ys: known(e), opacity: isDecided(e) ? 1 : 0.55, open: open(cell.cell, run), text: text(e) };
        }) })),
        ...(pooled ? series.map(({ line, i }) => ({ ...style(i, lines.length), r: 6, dots: whole.filter((e) => lineOf(e) === line).map((e) => {
          const cell = cellOf(run, axis, e.value, e.method);
          return { x: pooled.at, y: e.ratio, dx: dx(i) * 3, ys: known(e), opacity: isDecided(e) ? 1 : 0.55, open: open(cell.cell, run), text: `All α together\n${text(e)}` };
        }) })) : []),
        ...(overAlpha ? [] : [{ color: "var(--muted)", guides: names.map((value) => ({ x: place(value), text: preset(axis, value) })) }]),
      ],
    }),
  });
}

const mean = (logs) => Math.exp(logs.reduce((sum, x) => sum + x, 0) / logs.length);

/** The metric of energy: what an image has more or less than its reference. */
export const ENERGY = "bias_rel";

/** What a metric is called and how it is drawn: errors on a logarithmic axis, energy around 0. */
const METRICS = {
  [headline]: { word: "relMSE", log: true, title: "Error", middle: (all) => mean(all.map(Math.log)), say: "the geometric mean" },
  [ENERGY]: { word: "relative bias", log: false, title: "Energy created (above 0) or lost", middle: (all) => all.reduce((sum, x) => sum + x, 0) / all.length, say: "the mean" },
};

/** A metric over a property of the scene, one line a model and method. */
export function sweepFigure(run, axis, metric = headline) {
  const { word, log, title, middle, say } = METRICS[metric];
  const models = [...sceneAxes, ...variantAxes].filter((name) => ["brdf", "masking", "diffuse"].includes(name));
  const all = rows.filter((row) => row.run === run && row.axes[axis] !== "" && (log ? row.scores[metric] > 0 : Number.isFinite(row.scores[metric])) && row.axes.method !== "none");
  // One method goes without saying beside models.
  const ofWay = (row) => (variantAxes.some((name) => !["point_set", "run", axis, ...models].includes(name)) || !models.length ? variantLabel(row, ["point_set", "run", axis, ...models]) : "");
  const lineOf = (row) => unique([...models.map((name) => row.axes[name]), ofWay(row)]).filter(Boolean).join(" · ");
  if (!all.length) return null;
  const rest = sceneAxes.filter((name) => name !== axis && !models.includes(name)), common = sharedRows(all, (row) => JSON.stringify([lineOf(row), row.axes[axis]]), (row) => JSON.stringify(rest.map((name) => row.axes[name]))), { own } = common;
  const lines = unique(own.map(lineOf)), { values, place, x } = scaleOf(axis, unique(rows.map((row) => row.axes[axis]).filter((value) => value !== "")));
  // Two properties that differ have two channels: the first one's values the colours, the others the dashes and marks.
  const firsts = unique(lines.map((line) => line.split(" · ")[0])), rests = unique(lines.map((line) => line.split(" · ").slice(1).join(" · ")));
  const isCrossed = lines.length > 7 && firsts.length > 1 && firsts.length <= 7;
  const styleOf = (i) => {
    if (!isCrossed) return style(i, lines.length);
    const [first, ...rest] = lines[i].split(" · "), r = rests.indexOf(rest.join(" · "));
    return { color: COLORS[firsts.indexOf(first)], shape: SHAPES[r % SHAPES.length], dash: DASHES[r % DASHES.length] };
  };
  if (values.length < 2) return null;
  const points = lines.flatMap((line, i) => values.flatMap((value) => {
    const of = own.filter((row) => lineOf(row) === line && row.axes[axis] === value), errors = of.map((row) => row.scores[metric]);
    return of.length ? [{ line, i, value, error: middle(errors), lo: Math.min(...errors), hi: Math.max(...errors), n: of.length, row: of[0] }] : [];
  }));
  return figure({
    name: `sweep-${axis}${metric === headline ? "" : `-${metric}`}${runSuffix(run)}`,
    class: "lead-figure",
    title: `${title} over ${symbol(axis)}${runTitle(run)}`,
    note: `${word} of each model and method${points.some((p) => p.n > 1) ? `; ${say} over everything else, whiskers from the least to the largest.${sharedText(common, "settings")}` : "."} Click a mark for its image.`,
    legend: lines.map((line, i) => ({ label: line, ...styleOf(i) })),
    table: { columns: ["line", axis, metric, "smallest", "largest", "cells"], rows: points.map((p) => [p.line, p.value, p.error, p.lo, p.hi, p.n]), onrow: (i) => open(points[i].row.cell, run)() },
    draw: xy({
      x: { ...x, label: symbol(axis) },
      y: { label: word, log, share: `sweep-${axis}-${metric} y`, domain: domain([...points.flatMap((p) => [p.lo, p.hi]), ...(log ? [] : [0])], log) },
      marks: [
        ...(log ? [] : [{ rule: 0, color: "var(--ink)", width: 1.2 }]),
        ...lines.map((line, i) => ({ line: points.filter((p) => p.i === i).map((p) => [place(p.value), p.error]), ...styleOf(i), width: 2 })),
        ...lines.map((line, i) => ({ ...styleOf(i), r: 4, dots: points.filter((p) => p.i === i).map((p) => ({ x: place(p.value), y: p.error, ys: p.n > 1 ? [p.lo, p.hi] : undefined, open: open(p.row.cell, run),
          text: `${line} · ${symbol(axis)} ${p.value}\n${word} ${number(p.error)}${p.n > 1 ? ` (${number(p.lo)} to ${number(p.hi)}, ${p.n} cells)` : ""}` })) })),
      ],
    }),
  });
}

/** Error over the dynamic range of the light; null where fewer than three ranges are known: two lights differ in more than that. */
export function rangeFigure(run) {
  const points = model.runs[run].dynamic_range, methods = unique(points.map((p) => p.method)), series = unique(points.map((p) => p.series));
  if (unique(points.map((p) => p.range)).length < 3) return null;
  const cell = (p) => rows.find((row) => row.run === run && row.axes.environment === p.environment && (p.clip_log2 === "" || row.axes.environment_clip_log2 === p.clip_log2) && `${row.axes.method} ${row.axes.samples}`.trim() === p.method);
  const show = (p) => { const found = cell(p); return found && open(found.cell, run); };
  const lines = series.flatMap((of, s) => methods.map((method, m) => ({ own: points.filter((p) => p.series === of && p.method === method), dash: DASHES[s % DASHES.length], color: COLORS[m % 7], shape: SHAPES[m % SHAPES.length] })));
  return figure({
    name: `dynamic-range${runSuffix(run)}`,
    class: "lead-figure",
    title: `Error over the dynamic range of the light${runTitle(run)}`,
    note: "Median over everything else, whiskers: the middle half. Stops: log2 of the peak over the mean luminance.",
    legend: [...methods.map((method, m) => ({ label: method, color: COLORS[m % 7], shape: SHAPES[m % SHAPES.length] })), ...(series.length > 1 ? series.map((of, s) => ({ label: short("environment", of), color: "var(--muted)", dash: DASHES[s % DASHES.length] ?? "1 0" })) : [])],
    table: { columns: ["series", "environment", "environment_clip_log2", "dynamic_range_stops", "method", headline, "lower_quartile", "upper_quartile", "cells"], rows: points.map((p) => [p.series, p.environment, p.clip_log2, p.range, p.method, p.median, p.lower_quartile, p.upper_quartile, p.n]), onrow: (i) => show(points[i])?.() },
    draw: xy({
      x: { label: "dynamic range, stops", share: "dynamic-range x", domain: domain(points.map((p) => p.range)) },
      y: { label: "relMSE", log: true, share: "dynamic-range y", domain: domain(points.flatMap((p) => [p.lower_quartile, p.upper_quartile]), true) },
      marks: [
        ...lines.map(({ own, ...one }) => ({ line: own.map((p) => [p.range, p.median]), ...one, width: 1.8 })),
        ...lines.map(({ own, ...one }) => ({ ...one, r: 3.8, dots: own.map((p) => ({ x: p.range, y: p.median, ys: p.n > 1 ? [p.lower_quartile, p.upper_quartile] : undefined, open: show(p), text: `${p.method} · ${short("environment", p.environment)}\n${number(p.range)} stops: relMSE ${number(p.median)} (${number(p.lower_quartile)} to ${number(p.upper_quartile)})` })) })),
      ],
    }),
  });
}
