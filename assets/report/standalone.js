// A figure as an SVG file that needs nothing of the page: styles written out, with title, note and legend.

import { s } from "report/dom";

/** What a style sheet may have set and a drawing needs. */
const PAINT = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "stroke-opacity", "opacity", "paint-order", "visibility"];
const LETTERS = ["font-family", "font-size", "font-weight", "font-style", "font-variant-numeric", "text-anchor", "dominant-baseline"];
/** Of the page alone: the keyboard's frame, places for the pointer, and what points to other elements. */
const PAGE_PARTS = ".ring, rect.open:not(.dot), desc";
const PAGE_ATTRIBUTES = ["style", "class", "tabindex", "role", "aria-labelledby", "aria-hidden", "data-hint", "data-at"];

/** A copy of drawn elements that looks the same without the page: every style is an attribute with its computed value. */
function literal(drawn) {
  const copy = drawn.cloneNode(true), gone = [...drawn.querySelectorAll(PAGE_PARTS)];
  const [from, to] = [drawn, copy].map((root) => [root, ...root.querySelectorAll("*")]);
  from.forEach((element, i) => {
    const style = getComputedStyle(element);
    for (const name of PAGE_ATTRIBUTES) to[i].removeAttribute(name);
    if (["title", "desc", "defs", "clipPath"].includes(element.localName)) return;
    for (const name of element.localName === "text" ? [...PAINT, ...LETTERS] : PAINT) {
      const value = style.getPropertyValue(name);
      if (value) to[i].setAttribute(name, value);
    }
  });
  from.forEach((element, i) => { if (gone.includes(element)) to[i].remove(); });
  return copy;
}

const LINE = 17, GAP = 18, SWATCH = 32;

/** Words in lines that are no wider than `width`. */
function wrapped(text, width, measure) {
  const lines = [""];
  for (const word of text.split(/\s+/)) {
    const longer = lines.at(-1) ? `${lines.at(-1)} ${word}` : word;
    if (lines.at(-1) && measure(longer) > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}

/** The drawing of a figure as the text of an SVG file. Its coordinates stay; title and note stand above, the legend below. */
export function standalone(figure) {
  const svg = figure.querySelector(".stage svg"), copy = literal(svg);
  const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
  const page = getComputedStyle(document.body), muted = getComputedStyle(figure.querySelector(".legend, .note") ?? document.body).color;
  const pen = document.createElement("canvas").getContext("2d"), family = page.fontFamily;
  const measure = (size, weight = 400) => (text) => { pen.font = `${weight} ${size}px ${family}`; return pen.measureText(text).width; };
  const text = (words, x, y, size, fill, weight = 400) => s("text", { x, y, fill, "font-family": family, "font-size": size, "font-weight": weight }, words);
  const [title, note] = ["figcaption h2", ".note"].map((selector) => figure.querySelector(selector)?.textContent ?? ""), room = width - 16;
  const titles = wrapped(title, room, measure(15, 650)), notes = note ? wrapped(note, room, measure(12)) : [];
  const top = 12 + 20 * titles.length + LINE * notes.length;
  const head = s("g", {}, titles.map((line, i) => text(line, 8, 20 + 20 * i - top, 15, page.color, 650)),
    notes.map((line, i) => text(line, 8, 18 + 20 * titles.length + LINE * i - top, 12, muted)));
  const legend = s("g", {});
  let [x, y] = [8, height + 6];
  for (const entry of figure.querySelectorAll(".legend li")) {
    const label = entry.textContent, wide = SWATCH + measure(12)(label);
    if (x > 8 && x + wide > room) { x = 8; y += LINE; }
    legend.append(s("g", { transform: `translate(${x} ${y})` }, [...literal(entry.querySelector("svg")).childNodes]), text(label, x + SWATCH, y + 10, 12, muted));
    x += wide + GAP;
  }
  const bottom = legend.childNodes.length ? y + LINE + 4 - height : 0, whole = top + height + bottom;
  for (const [name, value] of Object.entries({ xmlns: "http://www.w3.org/2000/svg", viewBox: `0 ${-top} ${width} ${whole}`, width, height: whole })) copy.setAttribute(name, value);
  copy.prepend(s("title", {}, title), s("desc", {}, note), s("rect", { x: 0, y: -top, width, height: whole, fill: page.backgroundColor }), head);
  copy.append(legend);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(copy)}\n`;
}
