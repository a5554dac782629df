// Charts without axes: stacked bars, maps of coloured cells, and several maps in one figure.

import { COLORS, uniqueId, walkOnly } from "report/chart";
import { number, s } from "report/dom";
import { textWidth } from "report/labels";

/** Stacked bars, one a row: bars are {name, parts: [[part, value]], total, open}; colours follow the order of `parts`. */
export function bars({ bars, parts, unit }) {
  return (width, height, tip) => {
    const targets = [];
    const svg = s("svg", { width, height, class: "chart" });
    const widest = Math.max(...bars.map((bar) => textWidth(bar.name))), left = Math.min(width * 0.5, 14 + widest), letters = Math.min(12, (12 * (left - 10)) / widest);
    const longest = Math.max(...bars.map((bar) => bar.total)), rowHeight = height / bars.length;
    bars.forEach((bar, i) => {
      const y = i * rowHeight, middle = y + rowHeight / 2 + 4;
      let x = left;
      svg.append(s("text", { x: left - 8, y: middle, class: "tick", "text-anchor": "end", style: `font-size:${letters}px` }, bar.name));
      // Medians of parts do not add up to the median of the whole, which the bar's length is.
      const sum = bar.parts.reduce((all, [, value]) => all + value, 0) || 1;
      for (const [part, value] of bar.parts) {
        const w = ((value / sum) * bar.total / longest) * (width - left - 76);
        svg.append(s("rect", { x, y: y + rowHeight * 0.14, width: Math.max(0.5, w), height: rowHeight * 0.72, fill: COLORS[parts.indexOf(part) % 7] }, s("title", {}, `${bar.name}: ${part} ${number(value)} ${unit}`)));
        x += w;
      }
      svg.append(s("text", { x: x + 6, y: middle, class: "tick" }, `${number(bar.total)} ${unit}`));
      const text = [`${bar.name}: ${number(bar.total)} ${unit}`, ...(bar.passes ?? bar.parts).map(([part, value]) => `${part} ${number(value)}`)].join("\n");
      const box = { x: left - 2, y: y + rowHeight * 0.06, width: Math.max(4, x - left + 4), height: rowHeight * 0.88 };
      targets.push({ px: left, py: y + rowHeight / 2, box, dot: { text, open: bar.open } });
      if (bar.open) svg.append(s("rect", { ...box, fill: "transparent", class: "open", onclick: bar.open }, s("title", {}, text)));
    });
    walkOnly(svg, tip, targets, width);
    return svg;
  };
}

/** Letters of a map are never smaller, pixels. */
const LETTER_MIN = 9;
const LETTER_MAX = 14;

/** The values of a map, cell by cell, and what its letters need: a value may stand in two lines, parted at " / ". */
function lettering(cells) {
  const texts = cells.flat().map(({ text }) => String(text)), broken = texts.map((text) => text.split(" / "));
  const letters = (lines) => Math.max(2, ...lines.map((line) => line.length));
  return { whole: letters(texts), parted: letters(broken.flat()) };
}

const rowRoom = (rows, rowTitle) => 14 + 7 * Math.max(4, rowTitle.length, ...rows.map((label) => String(label).length));

const HEAD_LINE = 14, HEAD_LETTER = 6.6;

/** The labels of columns `w` wide, whole: in one line, else parted at " · ", else upright. {lines, isUpright, room: what they need above the cells}. */
function columnHeads(columns, w) {
  const longest = (lines) => HEAD_LETTER * Math.max(1, ...lines.flat().map((line) => String(line).length));
  const whole = columns.map((label) => [String(label)]), parted = columns.map((label) => String(label).split(" · "));
  for (const lines of [whole, parted]) if (longest(lines) <= w) return { lines, isUpright: false, room: 26 + HEAD_LINE * Math.max(1, ...lines.map((own) => own.length)) };
  return { lines: whole, isUpright: true, room: 30 + longest(whole) };
}

const MAP_ROW = 34;
/** The height of a map with these labels. */
const mapHeight = ({ rows, columns, rowTitle }, width) => 10 + columnHeads(columns, (width - Math.min(width * 0.36, rowRoom(rows, rowTitle)) - 4) / columns.length).room + MAP_ROW * rows.length;

/** The width below which the values of a map could not be read. */
function mapWidth({ rows, columns, rowTitle, cell }) {
  const cells = rows.map((_, r) => columns.map((_, c) => cell(r, c)));
  return Math.ceil(rowRoom(rows, rowTitle) + columns.length * (lettering(cells).parted * 0.6 * LETTER_MIN + 8) + 20);
}

/** Draws a map into `box` of an SVG. Returns the targets of the keyboard. */
function drawMap(svg, box, { rows, columns, rowTitle, columnTitle, cell }) {
  const width = box.width, left = Math.min(width * 0.36, rowRoom(rows, rowTitle));
  const w = (width - left - 4) / columns.length, { lines: heads, isUpright, room: top } = columnHeads(columns, w);
  const rowHeight = (box.height - top - 4) / rows.length;
  const cells = rows.map((_, r) => columns.map((_, c) => cell(r, c))), { whole, parted } = lettering(cells);
  const sized = (letters, lines) => Math.min(LETTER_MAX, (w - 6) / (0.6 * letters), (rowHeight * 0.72) / lines);
  const isParted = sized(whole, 1) < LETTER_MIN && parted < whole, size = isParted ? sized(parted, 2) : sized(whole, 1);
  const hatch = uniqueId("hatch"), targets = [], { x: x0, y: y0 } = box;
  svg.append(s("defs", {}, s("pattern", { id: hatch, width: 7, height: 7, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
    s("rect", { width: 7, height: 7, fill: "var(--paper)" }), s("line", { x1: 0, x2: 0, y1: 0, y2: 7, stroke: "var(--muted)", "stroke-width": 2 }))));
  svg.append(s("text", { x: x0 + left - 8, y: y0 + top - 8, class: "axis", "text-anchor": "end" }, rowTitle),
    s("text", { x: x0 + left + (columns.length * w) / 2, y: y0 + 12, class: "axis", "text-anchor": "middle" }, columnTitle));
  columns.forEach((label, c) => {
    const x = x0 + left + (c + 0.5) * w, y = y0 + top - 8;
    if (isUpright) svg.append(s("text", { transform: `translate(${x + 4} ${y}) rotate(-90)`, class: "tick" }, label));
    else heads[c].forEach((line, i) => svg.append(s("text", { x, y: y - HEAD_LINE * (heads[c].length - 1 - i), class: "tick", "text-anchor": "middle" }, line)));
  });
  rows.forEach((label, r) => {
    const y = y0 + top + r * rowHeight;
    svg.append(s("text", { x: x0 + left - 8, y: y + rowHeight / 2 + 4, class: "tick", "text-anchor": "end" }, label));
    columns.forEach((_, c) => {
      const value = cells[r][c], frame = { x: x0 + left + c * w + 1, y: y + 1, width: Math.max(1, w - 2), height: Math.max(1, rowHeight - 2) };
      const middle = frame.x + frame.width / 2, lines = isParted ? String(value.text).split(" / ").map((line, i, all) => (i + 1 < all.length ? `${line} /` : line)) : [value.text];
      const text = (line, i) => s("text", { x: middle, y: y + rowHeight / 2 + size * (0.36 + 1.1 * (i - (lines.length - 1) / 2)), "text-anchor": "middle", style: `fill:${value.ink};font-size:${size}px` }, line);
      const group = s("g", { class: value.open ? "cell open" : value.hatch ? "cell missing excluded-cell" : "cell missing" },
        s("rect", { ...frame, rx: 3, fill: value.color ?? (value.hatch ? `url(#${hatch})` : "var(--faint)") }),
        value.text && size >= LETTER_MIN - 0.01 && lines.map(text), s("title", {}, value.title));
      if (value.open) group.addEventListener("click", value.open);
      targets.push({ px: middle, py: y + rowHeight / 2, box: frame, dot: { text: value.title, open: value.open } });
      svg.append(group);
    });
  });
  return targets;
}

/**
 * A map of coloured cells with their values written in. rows, columns: labels; cell(r, c) -> {text, color, ink, title, open}; a cell
 * without a colour is missing, and hatched where `hatch` says that it was left out on purpose.
 */
function heatmap(map) {
  return (width, height, tip) => {
    const svg = s("svg", { width, height, class: "chart" });
    const targets = drawMap(svg, { x: 0, y: 0, width, height }, map);
    tip.hidden = true;
    walkOnly(svg, tip, targets, width);
    return svg;
  };
}

/** What a figure needs to draw a map: its drawing, and how wide it must be. */
export const mapped = (map) => ({ minWidth: mapWidth(map), height: (width) => mapHeight(map, width), draw: heatmap(map) });

/** Room of a panel with `rows` rows, its title included. */
const panelHeight = (rows) => 78 + 24 * rows;
/** The width at which neither the labels of columns are slanted nor values left out. */
function panelWidth({ rows, columns, rowTitle, cell }) {
  const { parted } = lettering(rows.map((_, r) => columns.map((_, c) => cell(r, c)))), label = Math.max(...columns.map((text) => String(text).length));
  return rowRoom(rows, rowTitle) + columns.length * Math.max(6.8 * label, parted * 0.6 * LETTER_MIN + 8) + 18;
}
const across = (width, all) => Math.max(1, Math.min(all.length, Math.floor(width / Math.max(...all.map(panelWidth)))));

/** The height that `panels` need at a width. */
export function panelsHeight(panels, width) {
  const columns = across(width, panels), heights = panels.map((panel) => panelHeight(panel.rows.length));
  let height = 0;
  for (let i = 0; i < heights.length; i += columns) height += Math.max(...heights.slice(i, i + columns));
  return height;
}

/** Several maps side by side, each with a title: {title, and what a map has}. */
export function panels(all) {
  return (width, height, tip) => {
    const svg = s("svg", { width, height, class: "chart" }), columns = across(width, all), w = width / columns, targets = [];
    let y = 0;
    for (let i = 0; i < all.length; i += columns) {
      const row = all.slice(i, i + columns);
      row.forEach((panel, c) => {
        svg.append(s("text", { x: c * w + 4, y: y + 14, class: "panel-title" }, panel.title));
        targets.push(...drawMap(svg, { x: c * w, y: y + 20, width: w - 12, height: panelHeight(panel.rows.length) - 30 }, panel));
      });
      y += Math.max(...row.map((panel) => panelHeight(panel.rows.length)));
    }
    tip.hidden = true;
    walkOnly(svg, tip, targets, width);
    return svg;
  };
}
