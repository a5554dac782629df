// What the comparison and the live view share: the canvas on its stage, pointers, the probe, the link to what is shown.

import { errorColor } from "report/data";
import { h, number, say, scrollBox, tableHead } from "report/dom";
import { link, state } from "report/state";

export const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));

/** The number that a text of an address holds, within a range; null when it holds none. */
export const real = (text, range) =>
  text === undefined || text === "" || !Number.isFinite(Number(text)) ? null : clamp(Number(text), range[0], range[1]);

/** Gives the canvas as many pixels as its stage has on the screen; false when it has them already. */
export function fitCanvas(canvas, stage) {
  const box = stage.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((side) =>
    Math.max(1, Math.round(side * (devicePixelRatio || 1))),
  );
  if (canvas.width === width && canvas.height === height) return false;
  [canvas.width, canvas.height] = [width, height];
  return true;
}

/**
 * Follows pointers over a canvas; all places are canvas pixels. `drag(dx, dy)`, `zoom(factor, [x, y])` by wheel or two
 * fingers, `hover([x, y])` without a button, `click([x, y])`, `rest()` at the end of a drag.
 */
export function followPointers(canvas, { drag, zoom, hover, click = null, rest = null }) {
  const pointers = new Map();
  let moved = false;
  let spread = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [
      ((event.clientX - box.left) / box.width) * canvas.width,
      ((event.clientY - box.top) / box.height) * canvas.height,
    ];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    moved = false;
    spread = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const here = place(event);
    const before = pointers.get(event.pointerId);
    if (!before) return hover(here);
    pointers.set(event.pointerId, here);
    moved ||= here[0] !== before[0] || here[1] !== before[1];
    const [a, b] = pointers.values();
    if (!b) return drag(here[0] - before[0], here[1] - before[1]);
    const distance = Math.hypot(a[0] - b[0], a[1] - b[1]);
    if (spread && Math.abs(distance / spread - 1) < 0.08) return undefined;
    if (spread) zoom(distance / spread, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
    spread = distance;
    return undefined;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (moved) rest?.();
    else click?.(place(event));
  });
  canvas.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  const wheel = (event) => {
    event.preventDefault();
    zoom(event.deltaY < 0 ? 1.2 : 1 / 1.2, place(event));
  };
  canvas.addEventListener("wheel", wheel, { passive: false });
}

/** The elements of a fixed text, which holds no data: {root, and each by its name in `data-ref`}. */
export function build(text) {
  const template = document.createElement("template");
  template.innerHTML = text;
  const named = [...template.content.querySelectorAll("[data-ref]")].map((part) => [
    part.getAttribute("data-ref"),
    part,
  ]);
  return { root: template.content.firstElementChild, ...Object.fromEntries(named) };
}

/** A labelled slider in such a text; its value stands beside its name. */
export const sliderText = (name, id, min, max, step) =>
  `<label class="slider" for="${id}"><span>${name} <output for="${id}"></output></span>
   <input type="range" data-ref="${id}" id="${id}" min="${min}" max="${max}" step="${step}"></label>`;

/** Round buttons over a stage: [sign, name, action]. */
export function stageTools(buttons, ...more) {
  const button = ([sign, name, onclick]) =>
    h("button", { type: "button", title: name, "aria-label": name, onclick }, sign);
  return h("div", { class: "zoom-tools" }, buttons.map(button), more);
}

/** The table of linear values at a pixel. Lines are {key, name, value: three numbers or null, error, isCurrent}. */
export class Probe {
  constructor() {
    this.place = h("span", {});
    this.body = h("tbody", {});
    this.table = h("table", {}, tableHead(["", "R", "G", "B", "error"], "image"), this.body);
    this.element = h(
      "section",
      { class: "probe", "aria-label": "Probe" },
      h("h2", {}, "Linear values ", this.place),
      scrollBox("Linear values", this.table),
    );
  }

  show(place, isSigned, lines) {
    say(this.place, place);
    say(this.table.querySelector("th:last-child"), isSigned ? "signed" : "error");
    const value = (v) => h("td", { "data-value": v ?? "", title: v === null ? "" : String(v) }, number(v, 3));
    const line = ({ key, name, value: values, error, isCurrent }) =>
      h(
        "tr",
        { "data-probe": key, class: isCurrent ? "current" : "" },
        h("th", { scope: "row" }, name),
        (values ?? [null, null, null]).map(value),
        errorCell(error, isSigned),
      );
    this.body.replaceChildren(...lines.map(line));
  }

  /** The current line in words. */
  get text() {
    const cells = this.body.querySelector(".current")?.children ?? [];
    return `${this.place.textContent}: ${[...cells].map((cell) => cell.textContent).join(" ")}`;
  }
}

/** The error of a texel with its colour, in the measure that is shown; null: an empty cell. */
function errorCell(error, isSigned) {
  const value = error && (isSigned ? error.signed : error.relative);
  const color = error && errorColor(isSigned ? "signed" : "error", error);
  const chip = error && h("i", { class: "chip", style: `background:rgb(${color})` });
  return h("td", { "data-value": value ?? "" }, error && [chip, number(value)]);
}

/** A button that copies the address of what is shown; `prepare` brings the address up to date. */
export function linkButton(prepare) {
  const copy = async () => {
    prepare();
    const address = new URL(link(state()), location.href).href;
    try {
      await navigator.clipboard.writeText(address);
      button.textContent = "Copied";
    } catch {
      prompt("Link to this view", address);
    }
    setTimeout(() => (button.textContent = "Copy link"), 1500);
  };
  const button = h("button", { type: "button", onclick: copy }, "Copy link");
  return button;
}
