// Shared by the comparison and the live view: the canvas on its stage, pointers, controls, the probe. Their elements
// are templates in the page (stage.html).

import { errorColor } from "report/data";
import { byId, h, number, percent, say } from "report/dom";

export const MODES = ["image", "error", "signed"];

export const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));

/** The number that a text of an address holds, within a range; null when it holds none. */
export const real = (text, range) =>
  text === undefined || text === "" || !Number.isFinite(Number(text)) ? null : clamp(Number(text), range[0], range[1]);

/** Gives the canvas as many pixels as its stage has on the screen; false when it has them already. */
export function fitCanvas(canvas, stage) {
  const box = stage.getBoundingClientRect();
  const pixels = (side) => Math.max(1, Math.round(side * (devicePixelRatio || 1)));
  const [width, height] = [pixels(box.width), pixels(box.height)];
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
  let [moved, spread] = [false, 0];
  const place = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const share = [(event.clientX - left) / width, (event.clientY - top) / height];
    return [share[0] * canvas.width, share[1] * canvas.height];
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

/** Moves the line of a wipe by pointer and arrow keys; `set` takes its place as a share of the width. */
export function followHandle(handle, stage, set) {
  const at = () => Number(handle.getAttribute("aria-valuenow")) / 100;
  handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener("pointermove", (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const { left, width } = stage.getBoundingClientRect();
    set(clamp((event.clientX - left) / width, 0, 1));
  });
  handle.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (!by) return;
    event.preventDefault();
    set(clamp(at() + by, 0, 1));
  });
}

/** Names what is shown, on both sides of the wipe; a share of null has no wipe. */
export function showSides(parts, left, right, share) {
  const { badge, rightBadge, handle } = parts;
  say(badge, left);
  say(rightBadge, right);
  rightBadge.hidden = handle.hidden = share === null;
  if (share === null) return;
  handle.style.left = `${share * 100}%`;
  handle.setAttribute("aria-valuenow", String(Math.round(share * 100)));
}

/** Puts a copy of a template into a view; its elements by their names in `data-ref`. @returns {Record<string, any>} */
export function build(view, id) {
  const template = /** @type {HTMLTemplateElement} */ (byId(id));
  view.replaceChildren(template.content.cloneNode(true));
  return Object.fromEntries([...view.querySelectorAll("[data-ref]")].map((part) => [part.dataset.ref, part]));
}

/** The controls of a view, by setting: sliders, boxes, fields, pickers, groups of buttons. */
export class Controls {
  constructor(view, set) {
    this.named = Object.fromEntries([...view.querySelectorAll("[data-set]")].map((part) => [part.dataset.set, part]));
    for (const [name, control] of Object.entries(this.named)) {
      const read = { checkbox: () => control.checked, range: () => Number(control.value) }[control.type];
      if (control.matches("input, select"))
        control.addEventListener("input", () => set(name, (read ?? (() => control.value))()));
      else control.addEventListener("click", ({ target }) => target.value && set(name, target.value));
    }
  }

  /** Shows settings; `texts` are beside the sliders. */
  show(settings, texts) {
    for (const [name, control] of Object.entries(this.named)) {
      const value = String(settings[name]);
      for (const button of control.querySelectorAll("button"))
        button.setAttribute("aria-pressed", String(button.value === value));
      if (control.type === "checkbox") control.checked = settings[name];
      else if (control.matches("input, select")) control.value = value;
      const output = control.labels?.[0].querySelector("output");
      if (!output) continue;
      say(output, texts[name]);
      control.setAttribute("aria-valuetext", texts[name]);
    }
  }

  /** Fills a picker with labels; without values of their own their places are its values. */
  fill(name, labels, values = labels.map((_, i) => i)) {
    this.named[name].replaceChildren(...labels.map((text, i) => h("option", { value: values[i] }, text))); // prettier-ignore
    this.named[name].closest("label").hidden = labels.length < 2;
  }

  disable(name, isDisabled) {
    const control = this.named[name];
    for (const part of [control, ...control.querySelectorAll("button")]) part.disabled = isDisabled;
  }

  /** The range of a slider, which also limits the address. */
  range(name) {
    return [Number(this.named[name].min), Number(this.named[name].max)];
  }
}

/** Fills the table of linear values. Lines are {key, name, value: three numbers or null, error, isCurrent}. */
export function showProbe(parts, where, isSigned, lines) {
  const { place, errorHead, lines: body } = parts;
  say(place, where);
  say(errorHead, isSigned ? "signed" : "error");
  const cell = (v) => h("td", { "data-value": v ?? "", title: v === null ? "" : String(v) }, number(v, 3));
  const line = ({ key, name, value, error, isCurrent }) => {
    const own = error && (isSigned ? error.signed : error.relative);
    const chip = error && h("i", { class: "chip", style: `background:rgb(${errorColor(isSigned, error)})` });
    const cells = (value ?? [null, null, null]).map(cell);
    const last = h("td", { "data-value": own ?? "" }, error && [chip, percent(own)]);
    const marks = { "data-probe": key, class: isCurrent ? "current" : "" };
    return h("tr", marks, h("th", { scope: "row" }, name), cells, last);
  };
  body.replaceChildren(...lines.map(line));
}
