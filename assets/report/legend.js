// The legend of error pictures: one fixed range for every image of the page.

import { model } from "report/data";
import { h, number } from "report/dom";

/** Fills `element` with the ramp, ticks and formula of the relative or the signed error; `marks` says that what lies beyond can be marked. */
export function fillErrorLegend(element, isSigned, marks) {
  const { magma, blue_red, relative, signed, relative_ticks, signed_ticks } = model.colors;
  const range = isSigned ? signed : relative;
  const stops = (isSigned ? blue_red : magma).filter((_, i) => i % 17 === 0).map((c) => `rgb(${c})`);
  const place = (t) =>
    (isSigned ? (t - range[0]) / (range[1] - range[0]) : Math.log(t / range[0]) / Math.log(range[1] / range[0])) * 100;
  const last = (isSigned ? signed_ticks : relative_ticks).length - 1,
    open = (i) => (i === last ? "≥ " : i === 0 ? "≤ " : "");
  element.replaceChildren(
    h("div", { class: "ramp", style: `background:linear-gradient(90deg,${stops.join(",")})` }),
    h(
      "div",
      { class: "ramp-ticks" },
      (isSigned ? signed_ticks : relative_ticks).map((t, i) =>
        h("span", { style: `left:${place(t)}%` }, `${open(i)}${number(t)}`),
      ),
    ),
    h(
      "p",
      {},
      isSigned
        ? "mean of d / √(r² + 0.01); blue too dark, red too bright. "
        : "√ of the RGB mean of d² / (r² + 0.01), as in errors.csv; the same range for every image. ",
      `Beyond the ends the colour stays${marks ? `; “Mark beyond the range” (C) stripes what lies ${isSigned ? "outside" : "above"}` : ""}.`,
    ),
  );
}
