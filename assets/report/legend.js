// The legend of error pictures: one fixed range for every image of the page.

import { errorMap } from "report/data";
import { h, percent } from "report/dom";

const RELATIVE = "√ of the RGB mean of d² / (r² + 0.01 m²), m the light's mean luminance; one range for all images. ";
const SIGNED = "mean of d / √(r² + 0.01 m²), m the light's mean luminance; blue too dark, red too bright. ";

/**
 * Fills `element` with the ramp, ticks and formula of the relative or the signed error, or hides it; `marks` adds that
 * values beyond can be marked.
 */
export function fillErrorLegend(element, mode, marks = false) {
  element.hidden = mode === "image";
  if (element.hidden) return;
  const isSigned = mode === "signed";
  const { colors, ticks, place } = errorMap(isSigned);
  const stops = colors.filter((_, i) => i % 17 === 0).map((c) => `rgb(${c})`);
  const open = (i) => (i === ticks.length - 1 ? "≥ " : i === 0 ? "≤ " : "");
  const tick = (value, i) => h("span", { style: `left:${place(value) * 100}%` }, `${open(i)}${percent(value)}`);
  const marked = `; “Mark beyond the range” (C) stripes what lies ${isSigned ? "outside" : "above"}`;
  element.replaceChildren(
    h("div", { class: "ramp", style: `background:linear-gradient(90deg,${stops.join(",")})` }),
    h("div", { class: "ramp-ticks" }, ticks.map(tick)),
    h("p", {}, isSigned ? SIGNED : RELATIVE, `Beyond the ends the colour stays${marks ? marked : ""}.`),
  );
}
