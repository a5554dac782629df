// The image table: scenes down, ways to make the image across. Every picture leads into the comparison.

import { HALF, exrLink, hasPixels, headline, mask, model, pixels } from "report/data";
import { axisOf, displayAxes, errorColor, sceneAxes, scenes, short, symbol, texelError, tone } from "report/data";
import { truthName, variantLabel, variantLabels, word } from "report/data";
import { choice, h, number, scrollBox, select, tableHead, unseen } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { go, keep } from "report/state";

const MODE_NAMES = { image: "Image", error: "Error", signed: "Signed" };

/** Draws an image, or its error, into a canvas; false if the page has no pixels of it. */
async function paint(canvas, row, mode, settings, isReference) {
  const texels = await pixels(isReference ? row.reference : row.image);
  if (!texels) return false;
  const { width, height, rgba } = texels;
  const picture = new ImageData(width, height);
  const out = picture.data;
  if (mode === "image") {
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
  canvas.style.aspectRatio = `${width} / ${height}`;
  canvas.getContext("2d").putImageData(picture, 0, 0);
  return true;
}

const tasks = new WeakMap();
const observer = new IntersectionObserver(
  (entries) => {
    for (const { target } of entries.filter((entry) => entry.isIntersecting)) {
      observer.unobserve(target);
      tasks.get(target)();
    }
  },
  { rootMargin: "300px" },
);

/** A picture with its score that opens the comparison; painted when scrolled into view. */
function thumbnail(row, mode, settings, { isReference = false, isLowest = false } = {}) {
  const canvas = h("canvas", { width: 8, height: 8, "aria-hidden": "true" });
  const floor = row.floor === null ? "" : `floor ${number(row.floor, 2)}`;
  const own = row.scores[headline] === null ? "failed" : number(row.scores[headline]);
  const isLimited = !isReference && ["reference-limited", "equal-within-noise"].includes(row.verdict);
  const why = "within ten times what the reference's own noise would give";
  const name = isReference ? truthName : variantLabel(row);
  const score = [isReference ? floor : own, isLimited && h("abbr", { title: why }, " ~")];
  const spoken = unseen(`Compare ${row.scene.label}, ${name}, ${headline} `);
  const lowest = isLowest && [h("span", { class: "lowest" }, "lowest"), " "];
  const place = { view: "compare", cell: row.cell, run: row.run || undefined };
  const onclick = () => go({ ...place, mode: mode === "image" ? undefined : mode });
  const marks = { type: "button", class: "thumb", "data-cell": row.cell, title: `${row.scene.label}: ${name}` };
  const told = h("span", { class: "thumb-text" }, h("span", {}, score));
  const button = h("button", { ...marks, onclick }, canvas, spoken, lowest, told);
  tasks.set(button, async () => {
    const isPainted = await paint(canvas, row, isReference ? "image" : mode, settings, isReference);
    button.classList.toggle("no-pixels", !isPainted);
  });
  observer.observe(button);
  return button;
}

/** The linear EXR files of every scene, if the page has no pixels. */
function exrTable() {
  const line = (scene, name, index, score) => {
    const link = () => ({ href: exrLink(index), "aria-label": `${scene.label}, ${name}: linear EXR` });
    const file = index === null ? "–" : h("a", link(), model.images[index].file);
    const fields = [name, score, file].map((field) => h("td", {}, field));
    return h("tr", {}, h("th", { scope: "row" }, scene.label), fields);
  };
  const body = scenes.flatMap((scene) => [
    line(scene, truthName, scene.main.reference, ""),
    ...scene.variants.map((row) => line(scene, variantLabel(row), row.image, number(row.scores[headline]))),
  ]);
  const table = h("table", {}, tableHead(["scene", "image", headline, "linear EXR"]), h("tbody", {}, body));
  return scrollBox("", "Linear EXR files", table);
}

/** Notes about the images: omitted ones, links to the contact sheets. */
function notesOf() {
  const notes = model.image_notes.map((text) => h("p", { class: "warning" }, text));
  const sheets = model.runs.flatMap((run) => run.sheets);
  if (sheets.length) {
    const links = sheets.map(([name, link], i) => [i ? " · " : "", h("a", { href: link }, name)]);
    const head = h("summary", {}, "Contact sheets: every image as a picture");
    notes.push(h("details", { class: "note sheets" }, head, links));
  }
  return notes;
}

/** The page of images. */
export function showGrid(view, state) {
  const again = (details) => {
    keep(details);
    showGrid(view, { ...state, ...details });
  };
  const title = h("h1", { tabindex: -1 }, "Images");
  const notes = notesOf();
  // Exposure and error maps need pixels.
  if (!model.images.some((image) => image.payload !== null)) {
    const table = model.images.length ? exrTable() : "";
    return view.replaceChildren(h("div", { class: "controls" }, title), ...notes, table);
  }
  const mode = Object.hasOwn(MODE_NAMES, state.mode ?? "") ? state.mode : "image";
  const chosen = (name) => (axisOf[name].values.includes(state[name]) ? state[name] : "");
  const isChosen = (scene) => sceneAxes.every((name) => !chosen(name) || scene.main.axes[name] === chosen(name));
  const own = scenes.filter(isChosen);
  const stops = Number(state.ev) || 0;
  const ev = h("input", { type: "range", min: -8, max: 8, step: 0.5, value: stops, "aria-label": "Exposure in stops" });
  ev.addEventListener("change", () => again({ ev: ev.value === "0" ? "" : ev.value }));
  const pick = (name) => {
    const values = axisOf[name].values.map((value) => [value, short(name, value)]);
    return select(symbol(name), [["", "all"], ...values], chosen(name), (value) => again({ [name]: value }));
  };
  const show = (value) => again({ mode: value === "image" ? "" : value });
  const modes = choice("What is shown", Object.entries(MODE_NAMES), mode, show);
  const exposure = h("label", { class: "choice" }, h("span", {}, `Exposure ${number(stops)} EV`), ev);
  const filters = sceneAxes.filter((name) => axisOf[name].values.length > 1).map(pick);
  const legend = h("div", { class: "error-legend" });
  if (mode !== "image") fillErrorLegend(legend, mode === "signed", false);
  // Methods without any pixels in the page (further point sets of a large run) would be empty columns.
  const holds = (label) => (row) => variantLabel(row) === label && (row.image === null || hasPixels(row));
  const labels = variantLabels.filter((label) => own.some((scene) => scene.variants.some(holds(label))));
  const line = (scene) => {
    const { exposure, contrast } = scene.main.axes;
    const settings = { exposure: (Number(exposure) || 1) * 2 ** stops, contrast: Number(contrast) || 1 };
    // A single image gets no "lowest" mark.
    const scores = scene.variants.map((row) => row.scores[headline]).filter((score) => score !== null);
    const best = scores.length > 1 ? Math.min(...scores) : NaN;
    const cell = (label) => {
      const row = scene.variants.find((one) => variantLabel(one) === label);
      const options = { isLowest: row?.scores[headline] === best };
      return h("td", {}, row ? thumbnail(row, mode, settings, options) : h("span", { class: "missing" }, "none"));
    };
    const names = sceneAxes.map((name) => h("span", {}, word(name, scene.main.axes[name])));
    const reference = h("td", {}, thumbnail(scene.main, mode, settings, { isReference: true }));
    return h("tr", {}, h("th", { scope: "row" }, names), reference, labels.map(cell)); // prettier-ignore
  };
  const head = tableHead([sceneAxes.map(symbol).join(" · ") || "scene", truthName, ...labels]);
  const curve = `At the cell's exposure${displayAxes.length ? " (of those tried the nearest to 1)" : ""}. `;
  const told = `${mode === "image" ? curve : ""}Below each image its ${headline}. Click one to compare it.`;
  const table = scrollBox("image-table", "Image table", h("table", {}, head, h("tbody", {}, own.map(line))));
  table.style.setProperty("--columns", String(labels.length + 1));
  const bar = h("div", { class: "controls" }, title, modes, exposure, filters);
  return view.replaceChildren(bar, ...notes, legend, h("p", { class: "note" }, told), table);
}
