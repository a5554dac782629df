// The comparison of images on linear data: flip in place, wipe, zoom to texels, error maps, probe. WebGL2.

import { HALF, exrLink, hasPixels, headline, idOf, model, rowOf, rows } from "report/data";
import { scenes, sceneLabel, texelError, truthName, variantLabel } from "report/data";
import { announce, choice, h, number, say, select, stopsText } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { Probe, build, clamp, fitCanvas, followPointers, linkButton, real, sliderText, stageTools } from "report/stage";
import { Place } from "report/place";
import { keep, state as current } from "report/state";
import { Surface } from "report/surface";
import { CONTRAST, STOPS, firstRow, key, keyedVariants } from "report/viewer-input";

const MODES = [
  ["image", "Image", "the image through the tone curve"],
  ["error", "Error", "relative error (E)"],
  ["signed", "Signed", "signed relative error (S)"],
];
const TONES = [
  ["curve", "Tone curve", "(e L / (e L + 1))^(contrast / 2.2), the project's (T)"],
  ["srgb", "sRGB", "clipped linear, sRGB-encoded (T)"],
];
const PANEL = `<aside class="panel" aria-label="Controls">
  <div class="row" data-ref="scene"></div><p class="note shared" data-ref="shared"></p>
  <ol class="variants" data-ref="variants" aria-label="Images of this scene"></ol>
  <div class="row" data-ref="modes"></div><div class="error-legend" data-ref="legend" hidden></div>
  ${sliderText("Exposure", "exposure", STOPS[0], STOPS[1], 0.1)}
  ${sliderText("Contrast", "contrast", CONTRAST[0], CONTRAST[1], 0.05)}
  <div class="row checks"><label><input type="checkbox" data-ref="splitBox"> Wipe to</label><span data-ref="with"></span>
    <label><input type="checkbox" data-ref="clipBox"> <span data-ref="clipText"></span></label></div>
  <div data-ref="rest"></div><p class="row"><a data-ref="exr">Linear EXR</a></p>
  <p class="note keys" id="viewer-keys"><kbd>1</kbd>–<kbd>9</kbd> image · hold <kbd>space</kbd> reference ·
    <kbd>E</kbd> error · <kbd>S</kbd> signed · <kbd>D</kbd> wipe · <kbd>?</kbd> all keys</p></aside>`;

const scoreText = (row) => (row.scores[headline] === null ? "failed" : number(row.scores[headline]));

export class Viewer {
  constructor(view) {
    this.view = view;
    this.isHeld = false;
    this.canvas = h("canvas", { tabindex: 0, role: "img", "aria-describedby": "viewer-keys" });
    this.place = new Place(this.canvas);
    this.surface = new Surface(this.canvas, () => this.show(current()));
    this.build();
  }

  // --- State -----------------------------------------------------------------------------------------------------

  /** Shows what the address asks for; without a cell the split sum, wiped against the reference. */
  async show(state) {
    const row = rowOf(state.cell, state.run ?? 0) ?? firstRow();
    if (!this.surface.gl) return this.sayNothing(row);
    const { scene } = row;
    this.row = row.original;
    this.other = scene.variants.find((one) => idOf(one) === state.with) ?? null;
    this.mode = MODES.some(([name]) => name === state.mode) ? state.mode : "image";
    this.tone = state.tone === "srgb" ? "srgb" : "curve";
    this.stops = real(state.ev, STOPS) ?? Math.log2(Number(row.axes.exposure) || 1);
    this.contrast = real(state.contrast, CONTRAST) ?? (Number(row.axes.contrast) || 1);
    this.isClipped = state.clip === "1";
    this.split = real(state.split, [0, 1]) ?? (state.cell ? null : 0.5);
    const isNew = this.scene !== scene;
    this.scene = scene;
    const own = scene.variants.flatMap((one) => [one.image, one.reference]);
    this.surface.wanted = new Set(own.filter((index) => index !== null));
    this.fillVariants();
    this.syncControls();
    const needed = [this.row, this.other].flatMap((one) => [one?.image ?? null, one?.reference ?? null]);
    await Promise.all(needed.map((index) => this.surface.load(index)));
    if (this.scene !== scene) return undefined;
    const { texels } = this;
    if (!texels) return this.sayNothing(row);
    const { window } = model.images[this.row.image];
    const pin = state.texel?.match(/^(\d+),(\d+)$/);
    this.isPinned = Boolean(pin);
    if (pin) this.probed = this.inside([pin[1] - window.x, pin[2] - window.y]);
    // Without a pointer the probe starts in the middle.
    this.probed ??= [texels.width >> 1, texels.height >> 1];
    this.stage.classList.remove("empty");
    this.resize();
    const { place } = this;
    if (isNew || !place.origin) place.fit(texels);
    const scale = real(state.zoom, place.range);
    if (scale !== null) {
      Object.assign(place, { isFitted: false, scale });
      const [x, y] = [real(state.x, [0, texels.width]), real(state.y, [0, texels.height])];
      place.center([x ?? texels.width / 2, y ?? texels.height / 2]);
    }
    this.draw();
    // The rest of the scene, so that flipping and the probe are instant.
    for (const index of this.surface.wanted) await this.surface.load(index);
    this.canvas.dataset.ready = scene.key;
    this.probe();
    return undefined;
  }

  /** Says why there is no picture. */
  sayNothing(row) {
    this.stage.classList.add("empty");
    // The next picture is fitted anew.
    this.place.origin = null;
    const failure = model.runs[row.run].failures.find((one) => one.cell === row.cell);
    const missing = failure ? `This cell failed: ${failure.reason}` : "No pixels of this cell are in the page.";
    const why = this.surface.gl ? missing : "This browser has no WebGL2, which the comparison needs.";
    this.canvas.setAttribute("aria-label", `${sceneLabel(row)}: ${variantLabel(row)}. ${why}`);
    this.canvas.dataset.shown = row.cell;
    this.mark.hidden = true;
    const link = row.image === null ? "" : h("a", { href: exrLink(row.image) }, "Its linear EXR");
    this.caption.replaceChildren(why, " ", link);
  }

  keepState() {
    const isPlaced = this.texels && !this.place.isFitted;
    const [x, y] = isPlaced ? this.place.middle.map((at) => Number(at.toFixed(2))) : ["", ""];
    const rounded = (value) => Number(value.toFixed(4));
    keep({
      ...{ cell: this.row.cell, run: this.row.run || "", with: this.other ? idOf(this.other) : "" },
      ...{ mode: this.mode === "image" ? "" : this.mode, tone: this.tone === "curve" ? "" : this.tone },
      ...{ ev: rounded(this.stops), contrast: rounded(this.contrast), clip: this.isClipped ? "1" : "" },
      split: this.split === null ? "" : rounded(this.split),
      texel: this.isPinned ? this.texelName.join(",") : "",
      ...{ zoom: isPlaced ? rounded(this.place.scale) : "", x, y },
    });
  }

  /** Changes what is shown. */
  set(details) {
    Object.assign(this, details);
    this.syncControls();
    this.draw();
    this.keepState();
  }

  choose(row) {
    if (!this.surface.images.has(row.image) || !this.place.origin) {
      keep({ cell: row.cell, run: row.run || "", split: this.split ?? "" });
      this.show(current());
      return;
    }
    this.stage.classList.remove("empty");
    this.set({ row });
    this.markVariant();
  }

  step(by) {
    const shown = this.scene.variants.filter((row) => hasPixels(row) || row === this.row);
    this.choose(shown[(shown.indexOf(this.row) + by + shown.length) % shown.length]);
  }

  /** The same variant in another scene, beside the same one. */
  stepScene(by) {
    const scene = scenes[(scenes.indexOf(this.scene) + by + scenes.length) % scenes.length];
    const same = (wanted) => wanted && scene.variants.find((one) => variantLabel(one) === variantLabel(wanted));
    const row = same(this.row) ?? scene.variants.find(hasPixels) ?? scene.variants[0];
    const other = same(this.other);
    const split = this.split ?? "";
    keep({ cell: row.cell, run: row.run || "", with: other ? idOf(other) : "", split, zoom: "", x: "", y: "" });
    this.show(current());
  }

  // --- Place -----------------------------------------------------------------------------------------------------

  get texels() {
    return this.surface.images.get(this.row?.image);
  }

  inside(place) {
    return place.map((at, i) => clamp(at, 0, [this.texels.width, this.texels.height][i] - 1));
  }

  /** Fits the canvas to its stage, and the image to the canvas; a place that the reader has chosen stays in the middle. */
  resize() {
    const { place } = this;
    const middle = place.origin && place.middle;
    if (!this.stage.clientWidth || !fitCanvas(this.canvas, this.stage)) return false;
    if (middle && place.isFitted) place.fit(this.texels);
    else if (middle) place.center(middle);
    return true;
  }

  zoom(factor, pixel = [this.canvas.width / 2, this.canvas.height / 2]) {
    if (!this.place.origin) return;
    this.place.zoom(factor, pixel);
    this.set({});
  }

  refit() {
    if (!this.texels) return;
    this.place.fit(this.texels);
    this.set({});
  }

  // --- Drawing ---------------------------------------------------------------------------------------------------

  draw() {
    const { images } = this.surface;
    const reference = images.get(this.row.reference);
    const left = this.isHeld ? reference : this.texels;
    if (!left || !reference || !this.place.origin) return;
    const right = this.other ? images.get(this.other.image) : reference;
    const [mode, tone] = [MODES, TONES].map((list, i) =>
      list.findIndex(([name]) => name === [this.mode, this.tone][i]),
    );
    const look = { mode, tone, exposure: 2 ** this.stops, contrast: this.contrast };
    const rightReference = images.get(this.other?.reference) ?? reference;
    const { split, isClipped: clipped } = this;
    const { origin, scale } = this.place;
    this.surface.draw({
      left,
      reference,
      right: right ?? reference,
      rightReference,
      origin,
      scale,
      split,
      clipped,
      look,
    });
    this.describe();
    this.probe();
  }

  describe() {
    const { row, other, split, isHeld } = this;
    const [left, right] = [isHeld ? truthName : variantLabel(row), other ? variantLabel(other) : truthName];
    say(this.badge, left);
    say(this.rightBadge, right);
    this.badge.classList.toggle("is-reference", isHeld);
    this.rightBadge.classList.toggle("is-reference", !other);
    this.rightBadge.hidden = this.handle.hidden = split === null;
    this.handle.style.left = `${(split ?? 0) * 100}%`;
    this.handle.setAttribute("aria-valuenow", String(Math.round((split ?? 0) * 100)));
    const shown = split === null ? left : `${left} | ${right}`;
    const score = isHeld ? "" : `; ${headline} ${scoreText(row)}`;
    this.canvas.setAttribute("aria-label", `${this.scene.label}: ${shown}, ${this.mode}${score}`);
    Object.assign(this.canvas.dataset, { shown: isHeld ? "reference" : row.cell, mode: this.mode });
    const { scale } = this.place;
    say(this.scaleText, scale >= 1 ? `${number(scale)}×` : `1/${number(1 / scale)}`);
  }

  // --- Probe -----------------------------------------------------------------------------------------------------

  /** The probed texel in the whole image, of which the page may hold a window. */
  get texelName() {
    const { x, y } = model.images[this.row.image]?.window ?? { x: 0, y: 0 };
    return [this.probed[0] + x, this.probed[1] + y];
  }

  /** Every variant's linear values at the probed texel. */
  probe() {
    if (!this.scene || !this.probed || !this.place.origin) return;
    const [x, y] = this.probed;
    this.placeMark();
    const entryOf = (index) => {
      const entry = this.surface.images.get(index);
      return entry && x >= 0 && y >= 0 && x < entry.width && y < entry.height ? entry : null;
    };
    const at = (index) => {
      const entry = entryOf(index);
      return entry && [0, 1, 2].map((c) => HALF[entry.rgba[4 * (y * entry.width + x) + c]]);
    };
    const shown = this.scene.variants.filter(hasPixels);
    const references = [...new Set(shown.map((row) => row.reference))];
    const truths = references.map((index, i) => {
      const name = references.length > 1 ? `${truthName} ${i + 1}` : truthName;
      return { key: `reference-${index}`, name, value: at(index), error: null, isCurrent: this.isHeld };
    });
    const lines = shown.map((row) => {
      const [value, truth, judge] = [at(row.image), at(row.reference), entryOf(row.reference)];
      const isCounted = judge && (!judge.maskBytes || judge.maskBytes[y * judge.width + x] === 1);
      const error = value && truth && isCounted ? texelError(value, truth) : null;
      return { key: idOf(row), name: variantLabel(row), value, error, isCurrent: !this.isHeld && row === this.row };
    });
    const place = `texel (${this.texelName.join(", ")})${this.isPinned ? " · pinned" : ""}`;
    this.probeTable.show(place, this.mode === "signed", [...truths, ...lines]);
  }

  /** A ring with cross hairs around the pinned texel: never smaller than can be seen, and as large as the texel. */
  placeMark() {
    this.mark.hidden = !this.isPinned;
    const ratio = this.canvas.width / (this.stage.clientWidth || 1);
    const { origin, scale } = this.place;
    const side = `${Math.max(14, (scale / ratio) * 1.5)}px`;
    const [left, top] = this.probed.map((at, i) => `${((at + 0.5 - origin[i]) * scale) / ratio}px`);
    Object.assign(this.mark.style, { left, top, width: side, height: side });
  }

  /** Moves the probe by whole texels, pins it, and keeps it in sight. */
  moveProbe(dx, dy) {
    if (!this.place.origin) return;
    this.probed = this.inside([this.probed[0] + dx, this.probed[1] + dy]);
    this.place.reveal(this.probed);
    this.set({ isPinned: true });
    announce(this.probeTable.text);
  }

  // --- Controls --------------------------------------------------------------------------------------------------

  build() {
    const panel = build(PANEL);
    this.panel = panel;
    this.modeChoice = choice("What is shown", MODES, "image", (mode) => this.set({ mode }));
    this.toneChoice = choice("Tone", TONES, "curve", (tone) => this.set({ tone }));
    panel.modes.append(this.modeChoice, this.toneChoice);
    this.sliders = { stops: panel.exposure, contrast: panel.contrast };
    for (const [name, input] of Object.entries(this.sliders))
      input.addEventListener("input", () => this.set({ [name]: Number(input.value) }));
    panel.clipBox.addEventListener("change", () => this.set({ isClipped: panel.clipBox.checked }));
    panel.splitBox.addEventListener("change", () => this.set({ split: panel.splitBox.checked ? 0.5 : null }));
    this.probeTable = new Probe();
    panel.rest.append(this.probeTable.element, linkButton(() => this.row && this.keepState())); // prettier-ignore
    this.badge = h("p", { class: "badge" });
    this.rightBadge = h("p", { class: "badge right", hidden: true });
    this.mark = h("i", { class: "probe-mark", "aria-hidden": "true", hidden: true });
    this.caption = h("p", { class: "caption" });
    const slide = { role: "slider", "aria-label": "Wipe", "aria-valuemin": 0, "aria-valuemax": 100 };
    this.handle = h("div", { class: "split-handle", tabindex: 0, hidden: true, ...slide });
    this.scaleText = h("span", { class: "scale-text" });
    const zooms = [
      ["−", "Zoom out (−)", () => this.zoom(1 / 1.5)],
      ["+", "Zoom in (+)", () => this.zoom(1.5)],
      ["Fit", "Fit (0)", () => this.refit()],
    ];
    const over = [this.mark, this.badge, this.rightBadge, this.handle, stageTools(zooms, this.scaleText), this.caption];
    this.stage = h("div", { class: "viewer-stage" }, this.canvas, ...over);
    const title = h("h1", { class: "visually-hidden" }, "Compare");
    this.view.replaceChildren(title, h("div", { class: "viewer" }, this.stage, panel.root));
    this.listen();
  }

  listen() {
    let frame = 0;
    followPointers(this.canvas, {
      drag: (dx, dy) => {
        if (!this.place.origin) return;
        this.place.pan([dx, dy]);
        this.draw();
      },
      zoom: (factor, pixel) => this.zoom(factor, pixel),
      hover: (pixel) => {
        if (!this.place.origin || this.isPinned) return;
        this.probed = this.place.at(pixel).map(Math.floor);
        cancelAnimationFrame(frame);
        frame = requestAnimationFrame(() => this.probe());
      },
      click: (pixel) => {
        if (!this.place.origin) return;
        const texel = this.place.at(pixel).map(Math.floor);
        this.set({ isPinned: !this.isPinned || String(this.probed) !== String(texel), probed: texel });
      },
      rest: () => this.row && this.keepState(),
    });
    const { handle, stage } = this;
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const box = stage.getBoundingClientRect();
      this.set({ split: clamp((event.clientX - box.left) / box.width, 0, 1) });
    });
    // Before the first image is placed there is nothing to draw: `show` fits it.
    new ResizeObserver(() => this.place.origin && this.texels && this.resize() && this.draw()).observe(stage);
  }

  syncControls() {
    const { panel } = this;
    const isImage = this.mode === "image";
    for (const [name, text] of [
      ["stops", stopsText(this.stops)],
      ["contrast", number(Number(this.contrast.toFixed(3)))],
    ]) {
      const input = this.sliders[name];
      input.value = String(this[name]);
      input.previousElementSibling.querySelector("output").textContent = text;
      // Errors are of linear values: no tone curve reaches them.
      input.disabled = !isImage || (name === "contrast" && this.tone === "srgb");
    }
    for (const button of this.toneChoice.querySelectorAll("button")) button.disabled = !isImage;
    this.modeChoice.press(this.mode);
    this.toneChoice.press(this.tone);
    panel.clipBox.checked = this.isClipped;
    panel.splitBox.checked = this.split !== null;
    say(panel.clipText, isImage ? "Mark clipped" : "Mark beyond the range");
    panel.legend.hidden = isImage;
    if (!isImage) fillErrorLegend(panel.legend, this.mode === "signed", true);
  }

  fillVariants() {
    const { panel, scene } = this;
    const at = scenes.indexOf(scene);
    const labels = scenes.map((one, i) => [i, one.label]);
    panel.scene.replaceChildren(select("Scene", labels, at, (index) => this.stepScene(Number(index) - at)));
    say(panel.shared, model.runs[this.row.run].shared ?? "");
    const others = scene.variants.filter(hasPixels).map((one) => [idOf(one), variantLabel(one)]);
    const chosen = this.other ? idOf(this.other) : "";
    const wipe = select("", [["", truthName], ...others], chosen, async (id) => {
      this.other = scene.variants.find((one) => idOf(one) === id) ?? null;
      await Promise.all([
        this.surface.load(this.other?.image ?? null),
        this.surface.load(this.other?.reference ?? null),
      ]);
      this.set({ split: this.split ?? 0.5 });
    });
    wipe.querySelector("select").setAttribute("aria-label", "Wipe to");
    panel.with.replaceChildren(wipe);
    // What has a key stands first, in the order of the keys; of many point sets the rest would bury it.
    const keyed = keyedVariants(scene);
    const rest = scene.variants.filter((row) => !keyed.includes(row));
    const item = (row, name) => {
      const parts = [
        h("kbd", {}, name),
        h("span", {}, variantLabel(row)),
        h("span", { class: "score" }, scoreText(row)),
      ];
      const marks = { type: "button", class: "variant", "data-cell": row.cell, "data-run": row.run };
      return h("li", {}, h("button", { ...marks, onclick: () => this.choose(row) }, ...parts));
    };
    const more = h("details", { open: rest.includes(this.row) }, h("summary", {}, `${rest.length} more without a key`));
    more.append(h("ol", { class: "variants" }, rest.map((row) => item(row, "·")))); // prettier-ignore
    panel.variants.replaceChildren(...keyed.map((row, i) => item(row, String(i + 1))));
    if (rest.length) panel.variants.append(h("li", {}, more));
    this.markVariant();
  }

  markVariant() {
    const { row, panel } = this;
    for (const button of panel.variants.querySelectorAll("button"))
      button.setAttribute(
        "aria-pressed",
        String(button.dataset.cell === row.cell && Number(button.dataset.run) === row.run),
      );
    const image = model.images[row.image];
    panel.exr.hidden = !image;
    if (image) {
      panel.exr.href = exrLink(row.image);
      const { window, size, clamped_count: count } = image;
      const isCut = window && (window.width !== size[0] || window.height !== size[1]);
      const place =
        isCut && `window ${window.width} × ${window.height} at (${window.x}, ${window.y}) of ${size.join(" × ")}`;
      const clamped = count > 0 && `${count} channels above 65504 are stored as 65504`;
      say(this.caption, [place, clamped].filter(Boolean).join("; "));
    }
    announce(`${this.scene.label}: ${variantLabel(row)}, ${headline} ${scoreText(row)}`);
  }

  /** Shows the reference while a key is down. */
  hold(isHeld) {
    if (this.isHeld === isHeld || !this.row) return;
    this.isHeld = isHeld;
    this.draw();
  }
}

let viewer = null;
export function showViewer(view, state) {
  if (!rows.length) return view.replaceChildren(h("p", { class: "note" }, "No cell is done."));
  // Controls without a picture would do nothing.
  if (!rows.some(hasPixels)) {
    const why = `There is nothing to compare: this page holds no images. ${model.image_notes.join(" ")}`;
    const title = h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Compare"));
    const link = h("p", {}, h("a", { href: "#images" }, "Links to the linear EXR files"));
    return view.replaceChildren(title, h("p", { class: "note", role: "status" }, why), link);
  }
  viewer ??= new Viewer(view);
  return viewer.show(state);
}
export const viewerKey = (event) => (viewer ? key(viewer, event) : false);
export const viewerRelease = () => viewer?.hold(false);
