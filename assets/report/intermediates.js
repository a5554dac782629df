// The list of pictures of what an image is made of, beside the images of the comparison.

import { intermediateNotes, intermediatesOf } from "report/data";
import { h, number } from "report/dom";

/** The name of a picture for readers: "prefiltered 2". */
export const intermediateLabel = ({ name }) => name.replace("-", " ");

/** How a picture shows its values. */
export function intermediateLegend({ encoding, clamped_count }) {
  const clamped = clamped_count ? ` ${clamped_count} channels above 65504 are stored as 65504.` : "";
  if (encoding === "radiance") return `Radiance through the tone curve.${clamped}`;
  if (encoding === "color") return "Encoded as sRGB.";
  const [red, ...rest] = encoding.linear.map(({ min, max }) => `${number(min)} to ${number(max)}`);
  const isOne = rest.every((text) => text === red);
  return `Linear: black to white is ${isOne ? red : `${red}, ${rest.join(", ")} (R, G, B)`}.`;
}

/** Fills `element` with a button for each picture of what the image of `row` is made of; `show` takes its name. */
export function fillIntermediates(element, row, show) {
  // The same buttons stay, and with them the focus.
  const set = String(row.intermediates);
  if (element.dataset.pictures === set) return;
  element.dataset.pictures = set;
  const all = intermediatesOf(row);
  const button = (one) => {
    const title = `${intermediateLegend(one)} In full size: splitsum render --show ${one.name}`;
    return h(
      "button",
      { type: "button", value: one.name, title, onclick: () => show(one.name) },
      intermediateLabel(one),
    );
  };
  // Commands are between backquotes.
  const words = (text) => text.split("`").map((part, i) => (i % 2 ? h("code", {}, part) : part));
  const notes = intermediateNotes.map((text) => h("p", { class: "note" }, ...words(text)));
  const list = h("div", { class: "intermediates" }, ...all.map(button));
  element.replaceChildren(h("h2", {}, "Made of"), all.length ? list : "", ...notes);
  element.hidden = !all.length && !notes.length;
}

/** Marks the picture that is shown; null is the image itself. */
export function markIntermediate(element, name) {
  for (const button of element.querySelectorAll("button"))
    button.setAttribute("aria-pressed", String(button.value === name));
}
