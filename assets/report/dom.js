// Elements and text. Text from data only ever becomes text nodes and attribute values, never markup.

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of children.flat(2))
    if (child !== null && child !== undefined && child !== false) element.append(child);
  return element;
}

/** An HTML element; `on...` attributes are listeners. */
export const h = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
export const byId = (id) => document.getElementById(id);

/** A number for people: `digits` significant digits, no exponent where one is not needed. */
export function number(x, digits = 3) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  if (x === 0) return "0";
  const magnitude = Math.abs(x);
  const text =
    magnitude < 1e-4 || magnitude >= 1e6
      ? x.toExponential(digits - 1).replace("e+", "e")
      : Number(x.toPrecision(digits)).toString();
  return text.replace("-", "−");
}

/** Exposure in stops with its factor. */
export const stopsText = (stops) =>
  `${stops >= 0 ? "+" : "−"}${number(Math.abs(Number(stops.toFixed(2))))} EV (× ${number(2 ** stops)})`;

/** Offers `text` as a file. */
export function download(name, text, type) {
  const link = h("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Whether a spreadsheet would run the text, as src/table/csv.rs says it. */
const isLikeFormula = (text) =>
  /^'*[=+\-@\t\r]/.test(text) &&
  !(/^[+-]/.test(text) && (Number.isFinite(Number(text)) || /^.(inf|infinity|nan)$/i.test(text)));

/** RFC 4180. */
export const csvText = (columns, rows) =>
  [columns, ...rows]
    .map((row) =>
      row
        .map((field) => {
          const plain = field === Infinity ? "inf" : String(field ?? ""),
            text = isLikeFormula(plain) ? `'${plain}` : plain;
          return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
        })
        .join(","),
    )
    .join("\n") + "\n";

/** Says something to screen readers. */
export function announce(text) {
  say(byId("announcer"), text);
}

/** What may be wider than its place: it scrolls, by keyboard too. */
export const scrollBox = (label, ...children) =>
  h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": label }, ...children);

/** Writes a text where it is another one: a new node costs a layout. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Text for screen readers alone. */
export const unseen = (text) => h("span", { class: "visually-hidden" }, text);

/** The head of a table: names of its columns; one that nothing is written over says what it holds to screen readers. */
export const tableHead = (names, hidden) =>
  h(
    "thead",
    {},
    h(
      "tr",
      {},
      names.map((name) => h("th", { scope: "col" }, name === "" ? unseen(hidden) : name)),
    ),
  );

/** A labelled choice. `options` are [value, label]. */
export function select(label, options, value, onchange) {
  const box = h(
    "select",
    { onchange: () => onchange(box.value) },
    options.map(([v, text]) => h("option", { value: v, selected: String(v) === String(value) }, text)),
  );
  return h("label", { class: "choice" }, h("span", {}, label), box);
}

/** Buttons of which one is pressed. */
export function choice(label, options, value, onchange) {
  const group = h("span", { class: "segments", role: "group", "aria-label": label });
  const press = (pressed) =>
    [...group.children].forEach((button) => button.setAttribute("aria-pressed", button.value === pressed));
  group.append(
    ...options.map(([v, text, title]) =>
      h(
        "button",
        {
          type: "button",
          value: v,
          title,
          onclick: () => {
            press(v);
            onchange(v);
          },
        },
        text,
      ),
    ),
  );
  press(value);
  group.press = press;
  return group;
}

/** A labelled slider with its value written beside the label; `oninput` gets numbers. */
export function slider(label, min, max, step, id, oninput) {
  const output = h("output", { for: id });
  const input = h("input", { type: "range", min, max, step, id, oninput: () => oninput(Number(input.value)) });
  // Named by `for`: the label of an element inside it would be that of the output.
  return { input, output, element: h("label", { class: "slider", for: id }, h("span", {}, label, " ", output), input) };
}
