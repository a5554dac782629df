// Charts as SVG: crisp at any size, readable by screen readers, saved as they are. One drawing serves the page and the file.

import { announce, csvText, download, h, number, s, tableHead } from "report/dom";
import { Crowd, alongRule, aroundMark, besideMark, textWidth } from "report/labels";
import { standalone } from "report/standalone";

/** Okabe and Ito's colours, told apart by the colour-blind too; each theme has its own shades. */
export const COLORS = Array.from({ length: 7 }, (_, i) => `var(--series-${i})`);
export const SHAPES = ["circle", "square", "triangle", "diamond", "cross", "down"];
export const DASHES = [undefined, "7 3", "2 3", "9 3 2 3"];
/** Viridis at `t` in [0, 1]; the page leaves out its palest end in the light theme and its darkest in the dark one. */
export function ordinal(index, count) {
  return `var(--ramp-${count < 2 ? 3 : Math.round((index / (count - 1)) * 6)})`;
}

function marker(shape, x, y, r, attributes) {
  const p = (points) => s("polygon", { ...attributes, points: points.map(([a, b]) => `${(x + a * r).toFixed(2)},${(y + b * r).toFixed(2)}`).join(" ") });
  switch (shape) {
    case "square": return s("rect", { ...attributes, x: x - 0.88 * r, y: y - 0.88 * r, width: 1.76 * r, height: 1.76 * r });
    case "triangle": return p([[0, -1.2], [1.1, 0.8], [-1.1, 0.8]]);
    case "down": return p([[0, 1.2], [1.1, -0.8], [-1.1, -0.8]]);
    case "ring": return s("circle", { ...attributes, fill: "none", style: `stroke:${attributes.fill};stroke-width:1.6`, cx: x, cy: y, r });
    case "diamond": return p([[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]]);
    // A style, because the outline of marks is set in the style sheet, which an attribute would not overrule.
    case "cross": return s("path", { ...attributes, fill: "none", style: `stroke:${attributes.fill};stroke-width:2.2`, d: `M${x - r},${y - r}L${x + r},${y + r}M${x - r},${y + r}L${x + r},${y - r}` });
    // Open arrows: what lies beyond the tried values, on either side.
    case "beyond": case "before": {
      const side = shape === "beyond" ? 1 : -1;
      return s("path", { ...attributes, fill: "var(--paper)", style: `stroke:${attributes.fill};stroke-width:2`, d: `M${x - side * 0.8 * r},${y - 1.1 * r}L${x + side * 1.2 * r},${y}L${x - side * 0.8 * r},${y + 1.1 * r}Z` });
    }
    default: return s("circle", { ...attributes, cx: x, cy: y, r });
  }
}

function scale({ log, domain: [lo, hi] }, from, to) {
  const f = log ? Math.log : (x) => x;
  const [a, b] = [f(lo), f(hi)];
  return (x) => from + ((f(x) - a) / (b - a || 1)) * (to - from);
}

/** A domain that holds `values`, with a margin. */
export function domain(values, log) {
  const usable = values.filter((x) => Number.isFinite(x) && (!log || x > 0));
  if (!usable.length) return log ? [0.1, 10] : [0, 1];
  let [lo, hi] = [Math.min(...usable), Math.max(...usable)];
  if (log) return lo === hi ? [lo / 2, hi * 2] : [lo * (lo / hi) ** 0.05, hi * (hi / lo) ** 0.05];
  return lo === hi ? [lo - 0.5, hi + 0.5] : [lo, hi + 0.04 * (hi - lo)];
}

function ticks({ log, domain: [lo, hi], ticks }, count) {
  if (ticks) return ticks.map((t) => [t, true]);
  // Within a factor of three the digits of a decade are too few.
  if (log && hi / lo > 3) {
    // As many labels as a reader needs to read a value off: fewer digits of a decade get one, the more decades there are.
    const decades = Math.log10(hi / lo), digits = [1, 2, 3, 4, 5, 6, 7, 8, 9];
    const named = decades > 4 ? [1] : decades > 2 ? [1, 3] : decades > 1 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9];
    const all = [];
    for (let e = Math.floor(Math.log10(lo)); e <= Math.ceil(Math.log10(hi)); e++) {
      for (const m of new Set([...digits, ...named])) { const t = Number((m * 10 ** e).toPrecision(3)); if (t >= lo * 0.999 && t <= hi * 1.001) all.push([t, named.includes(m)]); }
    }
    return all.sort(([s], [t]) => s - t);
  }
  const raw = (hi - lo) / count, power = 10 ** Math.floor(Math.log10(raw)), step = power * [1, 2, 5, 10].find((m) => m * power >= raw);
  const all = [];
  // Whole multiples, so that zero is zero.
  for (let i = Math.ceil(lo / step - 1e-9); i * step <= hi + step * 1e-9; i++) all.push([Number((i * step).toPrecision(12)), true]);
  return all;
}

const tickText = (t, log) => (log && (t < 1e-3 || t >= 1e5) ? number(t, 1) : number(t, 4));

let unique = 0;
/** A name that no other element of the page has. */
export const uniqueId = (stem) => `${stem}-${unique++}`;

/**
 * A figure around a drawing: title, legend, drawing, and buttons for SVG, CSV and the table.
 * spec: {name, title, note, legend: [{label, color, shape, dash, line, fill, hatch}], table: {columns, rows, onrow}, height, minWidth,
 *   draw(width, height) -> svg}
 */
export function figure(spec) {
  const id = uniqueId("figure");
  const stage = h("div", { class: "stage" });
  const table = h("div", { class: "figure-table", hidden: true });
  const toggle = h("button", { type: "button", "aria-expanded": "false", "aria-controls": `${id}-table`, onclick: () => {
    if (!table.firstChild) table.append(plainTable(spec.table));
    table.hidden = !table.hidden;
    toggle.setAttribute("aria-expanded", String(!table.hidden));
  } }, "Table");
  table.id = `${id}-table`;
  const tip = h("div", { class: "tip", hidden: true });
  const legend = spec.legend?.length > 0 && h("ul", { class: "legend" }, spec.legend.map(legendEntry));
  const element = h("figure", { class: `figure ${spec.class ?? ""}`, "data-figure": spec.name },
    h("figcaption", {}, h("h2", { id }, spec.title),
      h("span", { class: "figure-tools" },
        toggle,
        h("button", { type: "button", onclick: () => download(`${spec.name}.csv`, csvText(spec.table.columns, spec.table.rows), "text/csv") }, "CSV"),
        h("button", { type: "button", onclick: () => download(`${spec.name}.svg`, standalone(element), "image/svg+xml") }, "SVG"))),
    spec.note && h("p", { class: "note" }, spec.note),
    legend,
    h("div", { class: "stage-box" }, stage, tip), table);
  let drawn = 0;
  const draw = () => {
    const room = Math.floor(stage.clientWidth);
    if (room < 40 || room === drawn) return;
    drawn = room;
    // Drawn in units of the text size, so that letters and lines grow with it on very large screens; where that is too narrow to be read, the
    // stage scrolls.
    const unit = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16, w = Math.max(Math.round(room / unit), spec.minWidth ?? 0);
    const width = Math.max(room, Math.round((spec.minWidth ?? 0) * unit));
    const height = spec.height ? spec.height(w, unit) : Math.round(Math.min(420, Math.max(240, w * 0.55)));
    const svg = spec.draw(w, height, tip);
    svg.setAttribute("viewBox", `0 0 ${w} ${height}`);
    svg.setAttribute("width", width);
    svg.setAttribute("height", Math.round(height * unit));
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-labelledby", id);
    const description = s("desc", {}, `${spec.description ?? spec.note ?? ""}${svg.dataset.hint ?? ""}`);
    svg.prepend(description);
    stage.replaceChildren(svg);
    // A legend too long for its place scrolls, by keyboard too.
    if (legend) legend.toggleAttribute("tabindex", false);
    if (legend && legend.scrollHeight > legend.clientHeight + 1) legend.tabIndex = 0;
  };
  // Not within the notification: the drawing changes the size of what is observed.
  new ResizeObserver(() => requestAnimationFrame(draw)).observe(stage);
  return element;
}

/** A filled or hatched swatch. */
const shade = (fill, hatch) => [
  (fill || hatch) && s("rect", { x: 0.5, y: 0.5, width: 25, height: 11, rx: 2, fill: fill ?? "var(--paper)", stroke: "var(--cell-line)" }),
  hatch && s("path", { d: "M2,11L12,1M8,11L18,1M14,11L24,1", stroke: "var(--muted)", "stroke-width": 1.2, fill: "none" })];

function legendEntry({ label, color, shape, dash, line, band, fill, hatch }) {
  return h("li", {}, s("svg", { width: 26, height: 12, "aria-hidden": "true" },
    shade(fill, hatch),
    band && s("rect", { x: 0, y: 1, width: 26, height: 10, fill: color, opacity: 0.25 }),
    line !== false && color && s("line", { x1: 1, x2: 25, y1: 6, y2: 6, stroke: color, "stroke-width": 2, "stroke-dasharray": dash }),
    shape && marker(shape, 13, 6, 4, { fill: color })), label);
}

/** A field for people: the file has it exact, and so has the title. */
const fieldText = (field) => (typeof field === "number" || (String(field ?? "").length > 8 && Number.isFinite(Number(field))) ? number(Number(field), 4) : field ?? "");

/** A plain table of a figure; rows that lead somewhere have a button. */
function plainTable({ columns, rows, onrow }) {
  return h("table", {}, tableHead(onrow ? [...columns, ""] : columns, "images"),
    h("tbody", {}, rows.map((row, i) => h("tr", {}, row.map((field) => h("td", { title: field ?? "" }, fieldText(field))),
      onrow && h("td", {}, h("button", { type: "button", onclick: () => onrow(i) }, "Show"))))));
}

/** Axes with one name have one domain and the same ticks, so that charts side by side can be compared by eye. */
const shared = new Map();
function share(axis) {
  if (!axis.share) return () => axis;
  if (!shared.has(axis.share)) shared.set(axis.share, []);
  const all = shared.get(axis.share);
  all.push(axis);
  return () => {
    const values = all.flatMap((one) => one.domain);
    return { ...axis, domain: [Math.min(...values), Math.max(...values)], ticks: axis.ticks && [...new Set(all.flatMap((one) => one.ticks))].sort((a, b) => a - b) };
  };
}

/** Ticks whose labels have room: the ends first, then those between. Places of labels, and half of what each takes. */
function labelled(places, halves) {
  const last = places.length - 1, kept = new Set(), isFree = (i) => [...kept].every((k) => Math.abs(places[i] - places[k]) > halves[i] + halves[k]);
  for (const i of [0, last, ...places.keys()]) if (i >= 0 && !kept.has(i) && isFree(i)) kept.add(i);
  return kept;
}

/** The height of a second line of ticks. */
const STAGGER = 14;

/** Ticks on two lines in turn, by place: the line of each that has room. */
function staggered(places, halves) {
  const lines = [0, 1].map((line) => [...places.keys()].filter((i) => i % 2 === line));
  return new Map(lines.flatMap((own, line) => [...labelled(own.map((i) => places[i]), own.map((i) => halves[i] + 2))].map((k) => [own[k], line])));
}

/** An axis of names, whose ticks stand on two lines where one has no room for all: each may be the one that is asked for. */
function withLines(axis, along, box, width) {
  if (!axis.staggers) return axis;
  const at = scale(axis, box.left, box.right), majors = majorsOf(along), halves = majors.map((t) => textWidth(tickLabel(axis)(t)) / 2 + 3);
  return labelled(majors.map((t, i) => Math.min(at(t), width - halves[i] + 2)), halves).size < majors.length ? { ...axis, lines: 2 } : axis;
}

/**
 * A line from one value of an axis to another, with an open arrow where it goes on beyond the frame. `at` places a value along the line, `side`
 * the line across it; `isUpright` says which way it goes.
 */
function whisker([from, to], at, [lo, hi], side, isUpright, color) {
  const place = (value) => { const p = at(value); return Number.isNaN(p) ? [hi, false] : [Math.min(hi, Math.max(lo, p)), p < lo - 0.5 || p > hi + 0.5]; };
  const ends = [place(from), place(to)], xy = (along, across) => (isUpright ? `${across.toFixed(1)},${along.toFixed(1)}` : `${along.toFixed(1)},${across.toFixed(1)}`);
  const [[a], [b]] = ends, points = isUpright ? { x1: side, x2: side, y1: a, y2: b } : { x1: a, x2: b, y1: side, y2: side };
  const arrow = ([end, isOpen], other) => isOpen && s("path", { class: "open-end", fill: "none", stroke: color, "stroke-width": 1.6, opacity: 0.8,
    d: `M${xy(end + Math.sign(other - end) * 6, side - 4)}L${xy(end, side)}L${xy(end + Math.sign(other - end) * 6, side + 4)}` });
  return [s("line", { ...points, stroke: color, opacity: 0.55 }), arrow(ends[0], b), arrow(ends[1], a)].filter(Boolean);
}

/** The room that labels of an axis take on its left, pixels: the words beside it, and its ticks. */
const roomFor = (axis, labels) => 24 + Math.ceil(Math.max(0, ...labels.map((label) => textWidth(label)))) + 6;
const tickLabel = (axis) => (t) => (axis.format ?? tickText)(t, axis.log);
const majorsOf = (all) => all.filter(([, major]) => major).map(([t]) => t);

/** Grid, ticks and their labels around `box`; `width` is that of the picture. */
function drawAxes(svg, box, { x, y, along, up, width, isLeft, isBottom }) {
  const [sx, sy, textX, textY] = [scale(x, box.left, box.right), scale(y, box.bottom, box.top), tickLabel(x), tickLabel(y)];
  for (const [t, major] of along) svg.append(s("line", { x1: sx(t), x2: sx(t), y1: box.top, y2: box.bottom, class: major ? "grid major" : "grid" }));
  for (const [t, major] of up) svg.append(s("line", { x1: box.left, x2: box.right, y1: sy(t), y2: sy(t), class: major ? "grid major" : "grid" }));
  if (isBottom) {
    // A label at the end of the axis leans inwards rather than leaving the picture.
    const majors = majorsOf(along), halves = majors.map((t) => textWidth(textX(t)) / 2), places = majors.map((t, i) => Math.min(sx(t), width - halves[i] - 1));
    const kept = x.lines === 2 ? staggered(places, halves) : new Map([...labelled(places, halves.map((half) => half + 3))].map((i) => [i, 0]));
    for (const [i, t] of majors.entries()) if (kept.has(i)) svg.append(s("text", { x: places[i], y: box.bottom + 16 + STAGGER * kept.get(i), class: "tick", "text-anchor": "middle" }, textX(t)));
  }
  if (isLeft) {
    const rises = majorsOf(up), named = labelled(rises.map(sy), rises.map(() => 6.5));
    for (const [i, t] of rises.entries()) if (named.has(i)) svg.append(s("text", { x: box.left - 7, y: sy(t) + 4, class: "tick", "text-anchor": "end" }, textY(t)));
  }
}

/** The names of the axes around the whole of a drawing. */
function nameAxes(svg, box, height, x, y) {
  const room = box.bottom - box.top + 24, size = Math.min(12, (12 * room) / Math.max(1, textWidth(y.label, 12, 600)));
  svg.append(s("text", { x: (box.left + box.right) / 2, y: height - 6, class: "axis", "text-anchor": "middle" }, x.label));
  // On the left edge, whatever its length: it may reach beyond the frame, not beyond the picture.
  const reach = textWidth(y.label, size, 600) / 2, middle = Math.min(Math.max((box.top + box.bottom) / 2, reach + 2), height - reach - 2);
  svg.append(s("text", { transform: `translate(12 ${middle}) rotate(-90)`, class: "axis", "text-anchor": "middle", style: `font-size:${size}px` }, y.label));
}

/** The room of a name that stands upright beside its value, pixels. */
const GUIDE = 16;
/** A narrower drawing has no room for them. */
const GUIDED = 400;

/** Draws marks into `box`. Returns what the pointer and the keyboard reach. */
function drawMarks(svg, box, { x, y }, marks) {
  const [sx, sy] = [scale(x, box.left, box.right), scale(y, box.bottom, box.top)], clip = uniqueId("clip");
  svg.append(s("defs", {}, s("clipPath", { id: clip }, s("rect", { x: box.left - 6, y: box.top - 6, width: box.right - box.left + 12, height: box.bottom - box.top + 12 }))));
  const layer = s("g", { "clip-path": `url(#${clip})` }), crowd = new Crowd({ left: box.left, right: box.right, top: box.top - 4, bottom: box.bottom });
  svg.append(layer);
  const fits = (px, py) => Number.isFinite(px) && Number.isFinite(py), targets = [], words = [];
  const points = (all) => all.map(([a, b]) => [sx(a), sy(b)]).filter(([a, b]) => fits(a, b));
  const path = (all) => all.map(([a, b], i) => `${i ? "L" : "M"}${a.toFixed(1)},${b.toFixed(1)}`).join("");
  const whiskerOf = (ends, at, reach, side, isUpright, color) => {
    const parts = whisker(ends, at, reach, side, isUpright, color), [line] = parts, end = (n) => [Number(line.getAttribute(`x${n}`)), Number(line.getAttribute(`y${n}`))];
    crowd.line(end(1), end(2), "rule");
    layer.append(...parts);
  };
  for (const mark of marks) {
    if (mark.band) {
      const up = mark.band.map(([a, , hi]) => [a, hi]), down = mark.band.map(([a, lo]) => [a, lo]).reverse();
      layer.append(s("path", { d: `${path(points([...up, ...down]))}Z`, fill: mark.color, opacity: mark.opacity ?? 0.18 }));
    } else if (mark.line) {
      const own = points(mark.line);
      own.slice(1).forEach((to, i) => crowd.line(own[i], to));
      layer.append(s("path", { d: path(own), fill: "none", stroke: mark.color, "stroke-width": mark.width ?? 1.8, "stroke-dasharray": mark.dash, opacity: mark.opacity, "stroke-linejoin": "round" }));
    } else if ("rule" in mark) {
      const place = sy(mark.rule);
      if (!Number.isFinite(place)) continue;
      crowd.line([box.left, place], [box.right, place], "rule");
      layer.append(s("line", { x1: box.left, x2: box.right, y1: place, y2: place, class: "rule", stroke: mark.color, "stroke-width": mark.width ?? 1.5, "stroke-dasharray": mark.dash, opacity: mark.opacity }));
      if (mark.label) words.push([mark, mark.label, alongRule(box, place, mark)]);
    } else if (mark.dots) {
      for (const dot of mark.dots) {
        const [px, py] = [sx(dot.x) + (dot.dx ?? 0), sy(dot.y)];
        if (!fits(px, py)) continue;
        const color = dot.color ?? mark.color, r = dot.r ?? mark.r ?? 3.4;
        if (dot.xs) whiskerOf(dot.xs, sx, [box.left, box.right], py, false, color);
        if (dot.ys) whiskerOf(dot.ys, sy, [box.top, box.bottom], px, true, color);
        crowd.mark(px, py, r);
        layer.append(marker(dot.shape ?? mark.shape, px, py, r, { fill: color, class: `dot${dot.open ? " open" : ""}`, opacity: dot.opacity ?? mark.opacity }));
        if (dot.text) targets.push({ px, py, dot });
      }
    } else if (mark.labels) {
      const placed = mark.labels.map((one) => ({ ...one, px: sx(one.x), py: sy(one.y) })).filter(({ px, py }) => fits(px, py)).sort((a, b) => a.py - b.py);
      words.push(...placed.map((one) => [mark, one.text, besideMark(one.px, one.py, mark.dx)]));
    } else if (mark.guides && box.right - box.left >= GUIDED) {
      let free = box.left;
      for (const { x: at, text } of [...mark.guides].sort((a, b) => a.x - b.x)) {
        const px = sx(at), length = textWidth(text, 11.5);
        if (px - GUIDE < free) continue;
        free = px;
        crowd.add("word", px - GUIDE, px, box.top, box.top + length);
        svg.append(s("text", { transform: `translate(${(px - 5).toFixed(1)} ${box.top + 2}) rotate(-90)`, class: "mark", "text-anchor": "end", style: `fill:${mark.color}` }, text));
      }
    } else if (mark.corner) {
      const [first, second] = mark.corner === "top" ? ["end", "start"] : ["start", "end"], at = (anchor) => (anchor === "end" ? box.right - 6 : box.left + 8);
      words.push([mark, mark.text, [first, second].map((anchor, i) => ({ x: at(anchor), y: mark.corner === "top" ? box.top + 14 : box.bottom - 8, anchor, cost: 2 * i }))]);
    } else if (mark.text) {
      const [px, py] = [sx(mark.x), sy(mark.y)];
      if (fits(px, py)) words.push([mark, mark.text, aroundMark(px, py, mark.dx, mark.dy)]);
    }
  }
  // Words last, and those with fewest places first: what they would cover is known then.
  for (const [mark, text, places] of words.sort((a, b) => a[2].length - b[2].length)) {
    const { x: px, y: py, anchor } = crowd.place(text, places);
    svg.append(s("text", { x: px, y: py, class: "mark", "text-anchor": anchor, style: `fill:${mark.color}` }, text));
  }
  return targets;
}

/**
 * An xy chart. axes: {label, log, domain, ticks, format, share: the name of axes that are one}; what reaches beyond a domain ends in an open
 * arrow at the frame. Marks, in drawing order:
 *   {band: [[x, lo, hi]], color}  {line: [[x, y]], color, dash, width, opacity}  {rule: y, color, dash, label, below, isLeft}
 *   {dots: [{x, y, xs, ys, text, open, shape, color, r}]}  {text, x, y, dx, dy}: the name of a mark  {text, corner: "top" or "bottom"}
 *   {labels: [{x, y, text}], dx}: names beside marks  {guides: [{x, text}]}: names of values of x, those that have room
 * Words go where they cover least.
 */
export function xy({ x: ownX, y: ownY, marks }) {
  const [wholeX, wholeY] = [share(ownX), share(ownY)];
  return (width, height, tip) => {
    const [plainX, y] = [wholeX(), wholeY()], up = ticks(y, 6), along = ticks(plainX, width < 460 ? 5 : 9);
    const box = { left: roomFor(y, majorsOf(up).map(tickLabel(y))) - (y.label ? 0 : 14), right: width - 14, top: 10, bottom: height - 42 };
    const x = withLines(plainX, along, box, width), svg = s("svg", { width, height, class: "chart" });
    if (x.lines === 2) box.bottom -= STAGGER;
    drawAxes(svg, box, { x, y, along, up, width, isLeft: true, isBottom: true });
    nameAxes(svg, box, height, x, y);
    hover(svg, tip, drawMarks(svg, box, { x, y }, marks), width);
    return svg;
  };
}

/** Small charts: the room of one with its title, and how narrow it may be. */
const SMALL = { width: 126, height: 140, gap: 20, title: 20 };
const smallAcross = (width, count, perRow) => {
  const most = Math.max(1, Math.floor((width - 60 + SMALL.gap) / (SMALL.width + SMALL.gap))), whole = Math.min(perRow, count);
  // Whole rows of `perRow` are broken into equal parts.
  return Array.from({ length: whole }, (_, i) => whole - i).find((n) => n <= most && whole % n === 0) ?? 1;
};

/** Small charts with the same axes: all: [{title, marks}]; `perRow` of them belong beside each other. What a figure needs to draw them. */
export function smallCharts({ x: ownX, y: ownY, all, perRow = all.length }) {
  const [wholeX, wholeY] = [share(ownX), share(ownY)], acrossAt = (width) => smallAcross(width, all.length, perRow), rowsOf = (width) => Math.ceil(all.length / acrossAt(width));
  return {
    height: (width) => rowsOf(width) * (SMALL.height + SMALL.title) + 46,
    draw: (width, height, tip) => {
      const [x, y] = [wholeX(), wholeY()], across = acrossAt(width), rows = rowsOf(width);
      const up = ticks(y, 4), left = roomFor(y, majorsOf(up).map(tickLabel(y))), svg = s("svg", { width, height, class: "chart" });
      const w = (width - left - 14 + SMALL.gap) / across, h = (height - 46) / rows, targets = [];
      all.forEach(({ title, marks }, i) => {
        const [column, row] = [i % across, Math.floor(i / across)];
        const box = { left: left + column * w, right: left + (column + 1) * w - SMALL.gap, top: row * h + SMALL.title, bottom: (row + 1) * h - 8 };
        const size = Math.min(12.5, (12.5 * (box.right - box.left + SMALL.gap - 6)) / textWidth(title, 12.5, 650));
        svg.append(s("text", { x: box.left, y: box.top - 6, class: "panel-title", style: `font-size:${size}px` }, title));
        drawAxes(svg, box, { x, y, along: ticks(x, 4), up, width, isLeft: column === 0, isBottom: i + across >= all.length });
        targets.push(...drawMarks(svg, box, { x, y }, marks));
      });
      nameAxes(svg, { left, right: width - 14, top: SMALL.title, bottom: height - 46 }, height, x, y);
      hover(svg, tip, targets, width);
      return svg;
    },
  };
}

/** Shows the nearest target's text beside the pointer, a click opens it; with the keyboard see `walk`. */
function hover(svg, tip, targets, width) {
  const ring = s("circle", { r: 8, class: "ring", visibility: "hidden" });
  svg.append(ring);
  const show = (target) => {
    tip.hidden = !target;
    ring.setAttribute("visibility", target ? "visible" : "hidden");
    if (!target) return;
    ring.setAttribute("cx", target.px);
    ring.setAttribute("cy", target.py);
    showTip(svg, tip, target, width);
  };
  const nearest = (event) => {
    const box = svg.getBoundingClientRect(), unit = box.width / width;
    const [x, y] = [(event.clientX - box.left) / unit, (event.clientY - box.top) / unit];
    let best = null, distance = 32 ** 2;
    for (const target of targets) {
      const d = (target.px - x) ** 2 + (target.py - y) ** 2;
      if (d < distance) { distance = d; best = target; }
    }
    return best;
  };
  svg.addEventListener("pointermove", (event) => {
    const target = nearest(event);
    svg.style.cursor = target?.dot.open ? "pointer" : "";
    show(target);
  });
  svg.addEventListener("pointerleave", () => show(null));
  svg.addEventListener("click", (event) => nearest(event)?.dot.open?.());
  walk(svg, targets, show);
}

function showTip(svg, tip, target, width) {
  tip.textContent = target.dot.text;
  const unit = svg.getBoundingClientRect().width / width, side = target.px > width / 2 ? "right" : "left";
  const distance = (side === "right" ? width - target.px : target.px) + 14;
  // The tip stands beside the stage's window, the target in what scrolls below it.
  const scrolled = svg.parentElement.scrollLeft * (side === "right" ? -1 : 1);
  tip.style.cssText = `top:${Math.max(0, target.py - 14) * unit}px;${side}:${distance * unit - scrolled - (side === "right" ? svg.parentElement.scrollWidth - svg.parentElement.clientWidth : 0)}px`;
}

const WALK_HINT = " Arrow keys go from value to value, Enter opens the images.";

/**
 * Makes every target reachable by keyboard: arrows go to the next one in their direction (left and right also around the ends), Home and
 * End to the first and last, Enter opens it. `show` draws attention to a target, or with null ends it.
 */
function walk(svg, targets, show) {
  if (!targets.length) return;
  svg.setAttribute("tabindex", "0");
  svg.dataset.hint = WALK_HINT;
  const order = [...targets].sort((a, b) => a.px - b.px || a.py - b.py);
  let at = null;
  const go = (target) => {
    at = target ?? at;
    if (!at) return;
    svg.dataset.at = String(order.indexOf(at));
    show(at);
    announce(at.dot.text);
  };
  const step = (by) => go(order[at ? (order.indexOf(at) + by + order.length) % order.length : by > 0 ? 0 : order.length - 1]);
  // Up and down stay in the column as far as they can.
  const vertical = (sign) => {
    if (!at) return step(1);
    const beyond = targets.filter((target) => sign * (target.py - at.py) > 0.5);
    const cost = (target) => Math.abs(target.py - at.py) + 8 * Math.abs(target.px - at.px);
    return go(beyond.sort((a, b) => cost(a) - cost(b))[0]);
  };
  const actions = { ArrowRight: () => step(1), ArrowLeft: () => step(-1), ArrowUp: () => vertical(-1), ArrowDown: () => vertical(1), Home: () => go(order[0]), End: () => go(order.at(-1)), Enter: () => at?.dot.open?.() };
  svg.addEventListener("keydown", (event) => {
    if (!(event.key in actions) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    actions[event.key]();
  });
  svg.addEventListener("blur", () => show(null));
}

/** The keyboard alone, for drawings whose parts take the pointer themselves: the target is framed. */
export function walkOnly(svg, tip, targets, width) {
  const frame = s("rect", { class: "ring", visibility: "hidden", rx: 3 });
  svg.append(frame);
  walk(svg, targets, (target) => {
    tip.hidden = !target;
    frame.setAttribute("visibility", target ? "visible" : "hidden");
    if (!target) return;
    for (const [name, value] of Object.entries(target.box)) frame.setAttribute(name, value);
    showTip(svg, tip, target, width);
  });
}
