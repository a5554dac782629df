// Elements and text. Text from data only ever becomes text nodes and attribute values, never markup.

const isThere = (value) => value !== undefined && value !== null && value !== false;

/** An HTML element; `on...` attributes are listeners. */
export function h(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes).filter(([, value]) => isThere(value))) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.flat(2).filter(isThere));
  return element;
}
export const byId = (id) => document.getElementById(id);

/** A number for readers: `digits` significant digits, an exponent only if needed. */
export function number(x, digits = 3) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  if (x === 0) return "0";
  const isPlain = Math.abs(x) >= 1e-4 && Math.abs(x) < 1e6;
  const text = isPlain ? String(Number(x.toPrecision(digits))) : x.toExponential(digits - 1).replace("e+", "e");
  return text.replace("-", "−");
}

/** A share for readers: "9.27 %". */
export const percent = (x) => `${number(100 * x)}\u00a0%`;

/** Exposure in stops with its factor. */
export const stopsText = (stops) =>
  `${stops >= 0 ? "+" : "−"}${number(Math.abs(Number(stops.toFixed(2))))} EV (× ${number(2 ** stops)})`;

/** Offers `text` as a file. */
export function download(name, text, type) {
  const link = h("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Whether a spreadsheet would run the text; same rule as src/base/csv.rs. */
const isLikeFormula = (text) =>
  /^'*[=+\-@\t\r]/.test(text) &&
  !(/^[+-]/.test(text) && (Number.isFinite(Number(text)) || /^.(inf|infinity|nan)$/i.test(text)));

function csvField(field) {
  const plain = field === Infinity ? "inf" : String(field ?? "");
  const text = isLikeFormula(plain) ? `'${plain}` : plain;
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** RFC 4180. */
export const csvText = (columns, rows) => [columns, ...rows].map((row) => `${row.map(csvField).join(",")}\n`).join("");

/** Says something to screen readers. */
export const announce = (text) => say(byId("announcer"), text);

/** A box that scrolls content wider than itself, by keyboard too. */
export const scrollBox = (name, label, ...children) =>
  h("div", { class: `scroll ${name}`, tabindex: 0, role: "region", "aria-label": label }, ...children);

/** Replaces a text only if it differs: a new node costs a layout. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** The head of a table: names of its columns. */
export const tableHead = (names) =>
  h("thead", {}, h("tr", {}, names.map((name) => h("th", { scope: "col" }, name)))); // prettier-ignore

/** A labelled choice. `options` are [value, label]. */
export function select(label, options, value, onchange) {
  const option = ([own, text]) => h("option", { value: own, selected: String(own) === String(value) }, text);
  const box = h("select", { onchange: () => onchange(box.value) }, options.map(option));
  return h("label", { class: "choice" }, h("span", {}, label), box);
}

/** Buttons with one pressed; `options` are [value, label]. */
export function choice(label, options, value, onchange) {
  const state = (own) => ({ type: "button", value: own, "aria-pressed": String(own === value) });
  const button = ([own, text]) => h("button", { ...state(own), onclick: () => onchange(own) }, text);
  return h("span", { class: "segments", role: "group", "aria-label": label }, options.map(button));
}
