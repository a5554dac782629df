// The images: a row of pictures for each scene. Every picture leads into the comparison.

import { HALF, exrLink, firstRow, hasPixels, headline, inkOf, mask, model, pixels, sceneLabel } from "report/data";
import { axisOf, errorColor, sceneAxes, scenes, short, symbol, texelError, tone } from "report/data";
import { truthName, variantCode, variantLabel } from "report/data";
import { choice, h, number, select } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { go, keep } from "report/state";

const MODE_NAMES = { image: "Image", error: "Error", signed: "Signed" };

/** Draws an image, or its error, into a canvas, unless the page has no pixels of it. */
async function paint(canvas, row, mode, settings, isReference) {
  const texels = await pixels(isReference ? row.reference : row.image);
  if (!texels) return;
  const { width, height, rgba } = texels;
  const picture = new ImageData(width, height);
  const out = picture.data;
  if (mode === "image" || isReference) {
    // Display codes of every half float: a table makes a picture in a millisecond.
    const codes = Uint8Array.from(HALF, (x) => Math.round(255 * tone(x, settings)));
    for (let i = 0; i < rgba.length; i++) out[i] = i % 4 < 3 ? codes[rgba[i]] : 255;
  } else {
    const [truth, counts] = await Promise.all([pixels(row.reference), mask(row.reference)]);
    const mean = model.images[row.reference].light_mean;
    const rgb = (texels, i) => [0, 1, 2].map((c) => HALF[texels[4 * i + c]]);
    for (let i = 0; i < width * height; i++) {
      const isCounted = !counts || counts[i];
      const error = isCounted && texelError(rgb(rgba, i), rgb(truth.rgba, i), mean);
      out.set([...(error ? errorColor(mode === "signed", error) : model.colors.off_mask), 255], 4 * i);
    }
  }
  [canvas.width, canvas.height] = [width, height];
  canvas.style.cssText = `aspect-ratio: ${width} / ${height}; max-width: ${2 * width}px`;
  canvas.getContext("2d").putImageData(picture, 0, 0);
}

/** Calls `act` when an element comes into sight. */
function whenSeen(element, act) {
  const look = ([entry], observer) => {
    if (!entry.isIntersecting) return;
    observer.disconnect();
    act();
  };
  new IntersectionObserver(look, { rootMargin: "300px" }).observe(element);
}

/** The scores of a picture. */
function scoreText(row, isReference) {
  if (isReference) return row.floor === null ? "" : `${headline} of its noise ${number(row.floor, 2)}`;
  const { flip, [headline]: own = null } = row.scores;
  if (own === null) return "failed";
  return `${headline}\u00a0${number(own)}${flip === undefined || headline === "flip" ? "" : ` · flip\u00a0${number(flip, 2)}`}`;
}

/** A picture with its scores that opens the comparison; painted when scrolled into view. */
function thumbnail(row, mode, settings, isReference = false) {
  const canvas = h("canvas", { width: 8, height: 8, "aria-hidden": "true" });
  const name = isReference ? truthName : variantLabel(row);
  const place = { view: "compare", cell: row.cell, run: row.run || undefined, split: 0.5 };
  const onclick = () => go({ ...place, mode: mode === "image" ? undefined : mode });
  const marks = { type: "button", class: "thumb", "data-cell": row.cell, title: isReference ? "" : variantCode(row) };
  const label = h("span", { class: isReference ? "is-reference" : inkOf(row) }, h("i", { class: "dot" }), name);
  const score = h("small", {}, scoreText(row, isReference));
  const button = h("button", { ...marks, onclick }, canvas, label, score);
  whenSeen(button, () => paint(canvas, row, mode, settings, isReference));
  return button;
}

/** Links to the linear EXR files, if the page has no pixels. */
function exrList() {
  const file = (name, link) => h("li", {}, link ? h("a", { href: link }, name) : name);
  return h("ul", {}, ...model.images.map((image, index) => file(image.file, exrLink(index))));
}

/** Notes about the images: whose numbers they bear, omitted ones, links to the contact sheets. */
function notesOf(hasPictures) {
  const designs = model.designs.join(", ");
  const averages = designs && ` Answers average the scene ${designs}, which has no pictures.`;
  const own = `Numbers under a picture belong to that picture alone.${averages} Click a picture to compare it.`;
  const sheets = model.runs.flatMap((run) => run.sheets);
  const links = sheets.map(([name, link], i) => [i ? " · " : "", h("a", { href: link }, name)]);
  const notes = [hasPictures && own, ...model.image_notes].filter(Boolean).map((text) => h("p", { class: "note" }, text)); // prettier-ignore
  const summary = h("summary", {}, "Contact sheets: every image as a picture");
  return sheets.length ? [...notes, h("details", { class: "note" }, summary, links)] : notes;
}

/** The page of images. */
export function showGrid(view, state) {
  const again = (details) => {
    keep(details);
    showGrid(view, { ...state, ...details });
  };
  const title = h("h1", { tabindex: -1 }, "Images");
  // Exposure and error maps need pixels.
  if (!hasPixels(firstRow() ?? { image: null })) {
    return view.replaceChildren(h("div", { class: "controls" }, title), ...notesOf(false), exrList());
  }
  const mode = Object.hasOwn(MODE_NAMES, state.mode ?? "") ? state.mode : "image";
  const chosen = (name) => (axisOf[name].values.includes(state[name]) ? state[name] : "");
  const stops = Number(state.ev) || 0;
  const ev = h("input", { type: "range", min: -8, max: 8, step: 0.5, value: stops, "aria-label": "Exposure in stops" });
  ev.addEventListener("change", () => again({ ev: ev.value === "0" ? "" : ev.value }));
  const valuesOf = (name) => axisOf[name].values.filter((own) => scenes.some(({ main }) => main.axes[name] === own));
  const pick = (name) => {
    const values = valuesOf(name).map((value) => [value, short(name, value)]);
    return select(symbol(name), [["", "all"], ...values], chosen(name), (value) => again({ [name]: value }));
  };
  const modes = choice("What is shown", Object.entries(MODE_NAMES), mode, (value) => again({ mode: value }));
  const exposure = h("label", { class: "choice" }, h("span", {}, `Exposure ${number(stops)} EV`), ev);
  const legend = h("div", { class: "error-legend" });
  fillErrorLegend(legend, mode);
  const line = (scene) => {
    const { exposure, contrast } = scene.main.axes;
    const settings = { exposure: (Number(exposure) || 1) * 2 ** stops, contrast: Number(contrast) || 1 };
    // Images without pixels in the page (further point sets of a large run) would be empty.
    const own = scene.variants.filter((row) => row.image === null || hasPixels(row));
    const all = [thumbnail(scene.main, mode, settings, true), ...own.map((row) => thumbnail(row, mode, settings))];
    const thumbs = h("div", { class: "thumbs", style: `--count: ${all.length}` }, all);
    return h("section", { class: "scene" }, h("h2", {}, sceneLabel(scene.main)), thumbs);
  };
  const filters = sceneAxes.filter((name) => valuesOf(name).length > 1);
  const own = scenes.filter(({ main }) => filters.every((name) => !chosen(name) || main.axes[name] === chosen(name)));
  const bar = h("div", { class: "controls" }, title, modes, exposure, filters.map(pick));
  return view.replaceChildren(bar, ...notesOf(true), legend, ...own.map(line));
}
