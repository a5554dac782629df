// The image table: scenes down, ways to make the image across. Every picture leads into the comparison.

import {
  displayAxes,
  errorColor,
  exclusionOf,
  exrLink,
  hasPixels,
  headline,
  HALF,
  mask,
  model,
  overview,
  pixels,
  rows,
  sceneAxes,
  axisOf,
  scenes,
  short,
  symbol,
  texelError,
  tone,
  truthName,
  variantAxes,
  variantLabel,
  variantLabels,
} from "report/data";
import { choice, h, number, select, soft, unseen } from "report/dom";
import { sheetLinks } from "report/run";
import { go, keep } from "report/state";

/** Display codes of every half float: a table makes a picture in a millisecond. */
const luts = new Map();
function lut(settings) {
  const key = `${settings.tone} ${settings.exposure} ${settings.contrast}`;
  if (!luts.has(key)) {
    if (luts.size > 8) luts.clear();
    luts.set(
      key,
      Uint8Array.from(HALF, (x) => Math.round(255 * tone(x, settings))),
    );
  }
  return luts.get(key);
}

/** Draws an image, or its error, into a canvas. */
export async function paint(canvas, row, mode, settings, isReference = false) {
  const index = isReference ? row.reference : row.image;
  const texels = await (mode === "image" ? overview(index) : pixels(index));
  if (!texels) return false;
  const { width, height, rgba } = texels;
  const picture = new ImageData(width, height),
    out = picture.data;
  if (mode === "image") {
    const codes = lut(settings);
    for (let i = 0; i < rgba.length; i++) out[i] = codes[rgba[i]];
    for (let i = 3; i < out.length; i += 4) out[i] = 255;
  } else {
    const [truth, counts] = await Promise.all([pixels(row.reference), mask(row.reference)]);
    const off = model.colors.off_mask,
      t = [0, 0, 0],
      r = [0, 0, 0];
    for (let i = 0; i < width * height; i++) {
      let color = off;
      if (!counts || counts[i]) {
        for (let c = 0; c < 3; c++) {
          t[c] = HALF[rgba[4 * i + c]];
          r[c] = HALF[truth.rgba[4 * i + c]];
        }
        color = errorColor(mode, texelError(t, r));
      }
      out.set(color, 4 * i);
      out[4 * i + 3] = 255;
    }
  }
  [canvas.width, canvas.height] = [width, height];
  canvas.style.aspectRatio = `${width} / ${height}`;
  canvas.getContext("2d").putImageData(picture, 0, 0);
  return true;
}

/** A picture with its score that opens the comparison. */
export function thumbnail(row, mode, settings, { isReference = false, isLowest = false } = {}) {
  const name = isReference ? truthName : variantLabel(row),
    error = row.scores[headline];
  const canvas = h("canvas", { width: 8, height: 8, "aria-hidden": "true" });
  const score = isReference
    ? row.floor === null
      ? ""
      : `floor ${number(row.floor, 2)}`
    : error === null
      ? "failed"
      : number(error);
  const button = h(
    "button",
    {
      type: "button",
      class: "thumb",
      "data-cell": row.cell,
      title: `${row.scene.label}: ${name}`,
      onclick: () =>
        go({ view: "compare", cell: row.cell, run: row.run || undefined, mode: mode === "image" ? undefined : mode }),
    },
    canvas,
    unseen(`Compare ${row.scene.label}, ${name}, relMSE `),
    isLowest && [h("span", { class: "lowest" }, "lowest"), " "],
    h(
      "span",
      { class: "thumb-text" },
      h("span", {}, score),
      ["reference-limited", "equal-within-noise"].includes(row.verdict) &&
        !isReference &&
        h("abbr", { title: "within ten times what the reference's own noise would give" }, "~"),
    ),
  );
  whenSeen(button, async () => {
    if (!(await paint(canvas, row, mode, settings, isReference))) button.classList.add("no-pixels");
  });
  return button;
}

const tasks = new WeakMap();
const observer = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      observer.unobserve(target);
      tasks.get(target)();
    }
  },
  { rootMargin: "300px" },
);
function whenSeen(element, task) {
  tasks.set(element, task);
  observer.observe(element);
}

export const settingsOf = (row) => ({
  tone: "curve",
  exposure: Number(row.axes.exposure) || 1,
  contrast: Number(row.axes.contrast) || 1,
});

const variantOf = new Map();
/** What stands where a scene has no such image: the reason, if the experiment gives one. */
function missing(row, label) {
  if (!variantOf.size) rows.forEach((one) => variantOf.set(variantLabel(one), one));
  const pick = (from, names) => names.map((name) => [name, from.axes[name]]);
  const why = exclusionOf(Object.fromEntries([...pick(row, sceneAxes), ...pick(variantOf.get(label), variantAxes)]));
  return why === null
    ? h("span", { class: "excluded" }, "none")
    : h("span", { class: "excluded", title: why }, "excluded");
}

/** The linear EXR files of every scene, where the page holds no pixels. */
function exrTable() {
  const file = (index, label) =>
    index === null ? "–" : h("a", { href: exrLink(index), "aria-label": label }, model.images[index].file);
  const line = (row, name, index, score) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, row.scene.label),
      h("td", {}, name),
      h("td", {}, score),
      h("td", {}, file(index, `${row.scene.label}, ${name}: linear EXR`)),
    );
  return h(
    "div",
    { class: "scroll data-table", tabindex: 0, role: "region", "aria-label": "Linear EXR files" },
    h(
      "table",
      {},
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          ["scene", "image", headline, "linear EXR"].map((name) => h("th", { scope: "col" }, name)),
        ),
      ),
      h(
        "tbody",
        {},
        scenes.flatMap((scene) => [
          line(scene.main, truthName, scene.main.reference, ""),
          ...scene.variants.map((row) => line(row, variantLabel(row), row.image, number(row.scores[headline]))),
        ]),
      ),
    ),
  );
}

/** The page of images. */
export function showGrid(view, state) {
  const mode = ["error", "signed"].includes(state.mode) ? state.mode : "image";
  const filters = Object.fromEntries(
    sceneAxes.map((name) => [name, axisOf[name].values.includes(state[name]) ? state[name] : ""]),
  );
  const again = (details) => {
    keep(details);
    showGrid(view, { ...state, ...details });
  };
  const stops = Number(state.ev) || 0;
  const own = scenes.filter((scene) =>
    sceneAxes.every((name) => !filters[name] || scene.variants[0].axes[name] === filters[name]),
  );
  const ev = h("input", {
    type: "range",
    min: -8,
    max: 8,
    step: 0.5,
    value: stops,
    "aria-label": "Exposure in stops",
    onchange: () => again({ ev: ev.value === "0" ? "" : ev.value }),
  });
  const bar = h(
    "div",
    { class: "controls" },
    h("h1", { tabindex: -1 }, "Images"),
    choice(
      "What is shown",
      [
        ["image", "Image"],
        ["error", "Error"],
        ["signed", "Signed"],
      ],
      mode,
      (value) => again({ mode: value === "image" ? "" : value }),
    ),
    h(
      "label",
      { class: "choice" },
      h("span", { class: "exposure-text" }, `Exposure ${stops > 0 ? "+" : stops < 0 ? "−" : ""}${Math.abs(stops)} EV`),
      ev,
    ),
    sceneAxes
      .filter((name) => axisOf[name].values.length > 1)
      .map((name) =>
        select(
          symbol(name),
          [["", "all"], ...axisOf[name].values.map((value) => [value, short(name, value)])],
          filters[name],
          (value) => again({ [name]: value }),
        ),
      ),
  );
  const notes = model.image_notes.map((text) => h("p", { class: "warning" }, text));
  for (const one of model.runs.filter((each) => each.sheets.length))
    notes.push(
      h(
        "details",
        { class: "note" },
        h(
          "summary",
          {},
          `${one.sheets.length} contact ${one.sheets.length === 1 ? "sheet" : "sheets"} beside this report${model.runs.length > 1 ? ` · ${one.label}` : ""}: every image as a picture`,
        ),
        sheetLinks(one),
      ),
    );
  if (!model.images.some((image) => image.payload !== null)) {
    // Exposure and error maps need pixels.
    view.replaceChildren(
      h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Images")),
      ...notes,
      model.images.length ? exrTable() : "",
    );
    return;
  }
  const used = variantLabels.filter((label) =>
    own.some((scene) => scene.variants.some((row) => variantLabel(row) === label)),
  );
  // Ways of which the page holds no pixels at all (further point sets of a large run) would be columns of nothing.
  const labels = used.filter((label) =>
    own.some((scene) =>
      scene.variants.some((row) => variantLabel(row) === label && (row.image === null || hasPixels(row))),
    ),
  );
  if (labels.length < used.length)
    notes.push(
      h(
        "p",
        { class: "note" },
        `${used.length - labels.length} of ${used.length} ways to make the image have no pixels in this page and are not listed.`,
      ),
    );
  const head = h(
    "tr",
    {},
    h("th", { scope: "col" }, sceneAxes.map(symbol).join(" · ") || "scene"),
    h("th", { scope: "col" }, truthName),
    labels.map((label) => h("th", { scope: "col" }, soft(label))),
  );
  const body = own.map((scene) => {
    const first = scene.main,
      settings = settingsOf(first);
    settings.exposure *= 2 ** stops;
    // Of one image there is no lowest.
    const scores = scene.variants.map((row) => row.scores[headline]).filter((score) => score !== null);
    const best = scores.length > 1 ? Math.min(...scores) : NaN;
    return h(
      "tr",
      {},
      h(
        "th",
        { scope: "row" },
        sceneAxes.map((name) =>
          h("span", {}, soft(`${symbol(name) === name ? "" : `${symbol(name)} `}${short(name, first.axes[name])}`)),
        ),
      ),
      h("td", {}, thumbnail(first, "image", settings, { isReference: true })),
      labels.map((label) => {
        const row = scene.variants.find((one) => variantLabel(one) === label);
        return h(
          "td",
          {},
          row ? thumbnail(row, mode, settings, { isLowest: row.scores[headline] === best }) : missing(first, label),
        );
      }),
    );
  });
  const legend =
    mode === "image"
      ? `Through the project's tone curve at the cell's exposure${displayAxes.length ? " (of those tried the nearest to 1)" : ""}. `
      : mode === "error"
        ? "√ of the RGB mean of d² / (r² + 0.01), magma, 10⁻³ to 1, the same for all. "
        : "Mean of d / √(r² + 0.01), −0.5 (blue, too dark) to 0.5 (red, too bright). ";
  view.replaceChildren(
    bar,
    ...notes,
    h(
      "p",
      { class: "note" },
      legend,
      "Below each image its relMSE; the lowest of a scene is marked. Click one to compare it pixel by pixel.",
    ),
    h(
      "div",
      {
        class: "scroll image-table",
        style: `--columns:${labels.length + 1}`,
        tabindex: 0,
        role: "region",
        "aria-label": "Image table",
      },
      h("table", {}, h("thead", {}, head), h("tbody", {}, body)),
    ),
  );
}
