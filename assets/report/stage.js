// The stage of a picture that is drawn in a canvas: its size, and the link to what it shows. The comparison and the live view have one each.

import { h } from "report/dom";
import { link, state } from "report/state";

/** Gives the canvas as many pixels as its stage has on the screen; false when it has them already. */
export function fitCanvas(canvas, stage) {
  const ratio = devicePixelRatio || 1,
    box = stage.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((side) => Math.max(1, Math.round(side * ratio)));
  if (canvas.width === width && canvas.height === height) return false;
  [canvas.width, canvas.height] = [width, height];
  return true;
}

/** A button that copies the address of what is shown; `prepare` brings the address up to date. */
export function linkButton(prepare) {
  const button = h(
    "button",
    {
      type: "button",
      onclick: async () => {
        prepare();
        const address = new URL(link(state()), location.href).href;
        try {
          await navigator.clipboard.writeText(address);
          button.textContent = "Copied";
        } catch {
          prompt("Link to this view", address);
        }
        setTimeout(() => {
          button.textContent = "Copy link";
        }, 1500);
      },
    },
    "Copy link",
  );
  return button;
}
