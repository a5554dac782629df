// The comparison of images on linear data: flip in place, wipe, zoom to texels, error maps, probe. WebGL2.

import { HALF, exrLink, firstRow, hasPixels, headline, idOf, inkOf, intermediatesOf, model, rowOf } from "report/data";
import { sceneLabel, scenes, texelError, truthName, variantAxes, variantCode, variantLabel } from "report/data";
import { announce, h, number, say, stopsText } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { fillIntermediates, intermediateLabel, intermediateLegend, markIntermediate } from "report/intermediates";
import { Place } from "report/place";
import { Controls, MODES, build, clamp, fitCanvas, followHandle, followPointers, real } from "report/stage";
import { showProbe, showSides } from "report/stage";
import { keep, state as current } from "report/state";
import { Surface } from "report/surface";
import { key, keyedVariants } from "report/viewer-input";

const scoreText = (row) => (row.scores[headline] === null ? "failed" : number(row.scores[headline]));

class Viewer {
  constructor(view) {
    this.isHeld = false;
    this.parts = build(view, "compare-stage");
    this.canvas = this.parts.canvas;
    this.place = new Place(this.canvas);
    this.surface = new Surface(this.canvas, () => this.show(current()));
    this.controls = new Controls(view, (name, value) => {
      if (name === "at") this.stepScene(Number(value) - scenes.indexOf(this.scene));
      else if (name === "isSplit") this.set({ split: value ? 0.5 : null });
      else this.set({ [name]: value });
    });
    this.controls.fill("at", scenes.map(({ main }) => sceneLabel(main))); // prettier-ignore
    this.listen();
  }

  /** Shows the address's cell; by default the split sum, wiped against the reference. */
  async show(state) {
    const row = rowOf(state.cell, state.run ?? 0) ?? firstRow();
    if (!this.surface.gl) return this.sayNothing(row);
    const { scene } = row;
    this.row = row.original;
    this.mode = MODES.includes(state.mode) ? state.mode : "image";
    this.tone = state.tone === "srgb" ? "srgb" : "curve";
    this.stops = real(state.ev, this.controls.range("stops")) ?? Math.log2(Number(row.axes.exposure) || 1);
    this.contrast = real(state.contrast, this.controls.range("contrast")) ?? (Number(row.axes.contrast) || 1);
    this.isClipped = state.clip === "1";
    this.split = real(state.split, [0, 1]) ?? (state.cell ? null : 0.5);
    const isNew = this.scene !== scene;
    this.scene = scene;
    // A picture of what the image is made of, in place of the image.
    this.intermediate = intermediatesOf(this.row).find(({ name }) => name === state.show) ?? null;
    const own = [...scene.variants.flatMap((one) => [one.image, one.reference]), this.intermediate?.index ?? null];
    this.surface.wanted = new Set(own.filter((index) => index !== null));
    this.fillVariants();
    this.syncControls();
    const first = [this.row.image, this.row.reference, this.intermediate?.index ?? null];
    await Promise.all(first.map((index) => this.surface.load(index)));
    if (this.scene !== scene) return undefined;
    const { texels } = this;
    if (!texels) return this.sayNothing(row);
    const pin = state.texel?.match(/^(\d+),(\d+)$/);
    this.isPinned = Boolean(pin);
    if (pin) this.probed = this.inside([Number(pin[1]), Number(pin[2])]);
    // Without a pointer the probe starts in the middle.
    this.probed ??= [texels.width >> 1, texels.height >> 1];
    this.parts.stage.classList.remove("empty");
    this.resize();
    const { place } = this;
    if (isNew || !place.origin) this.fit();
    else this.fitOther();
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
    this.parts.stage.classList.add("empty");
    // The next picture is fitted again.
    this.place.origin = null;
    const failure = model.runs[row.run].failures.find((one) => one.cell === row.cell);
    const isDesign = model.designs.includes(row.axes.scene);
    const none = `${isDesign ? "This cell measures a scene that is not a picture. " : ""}No pixels of this cell are in the page.`;
    const missing = failure ? `This cell failed: ${failure.reason}` : none;
    const why = this.surface.gl ? missing : "This browser has no WebGL2, which the comparison needs.";
    this.canvas.setAttribute("aria-label", `${sceneLabel(row)}: ${variantLabel(row)}. ${why}`);
    this.canvas.dataset.shown = row.cell;
    this.parts.mark.hidden = true;
    const exr = row.image === null ? null : exrLink(row.image);
    this.parts.caption.replaceChildren(why, " ", exr ? h("a", { href: exr }, "Its linear EXR") : "");
  }

  keepState() {
    const isPlaced = this.texels && !this.place.isFitted;
    const [x, y] = isPlaced ? this.place.middle.map((at) => Number(at.toFixed(2))) : ["", ""];
    const rounded = (value) => Number(value.toFixed(4));
    keep({
      ...{ cell: this.row.cell, run: this.row.run || "" },
      show: this.intermediate?.name ?? "",
      ...{ mode: this.mode === "image" ? "" : this.mode, tone: this.tone === "curve" ? "" : this.tone },
      ...{ ev: rounded(this.stops), contrast: rounded(this.contrast), clip: this.isClipped ? "1" : "" },
      ...{ split: this.split === null ? "" : rounded(this.split), texel: this.isPinned ? this.probed.join(",") : "" },
      ...{ zoom: isPlaced ? rounded(this.place.scale) : "", x, y },
    });
  }

  /** Changes what is shown. */
  set(details) {
    if (!this.row) return;
    Object.assign(this, details);
    this.fitOther();
    this.syncControls();
    this.draw();
    this.keepState();
  }

  choose(row) {
    if (!this.surface.images.has(row.image) || !this.place.origin) {
      keep({ cell: row.cell, run: row.run || "", split: this.split ?? "", show: "" });
      this.show(current());
      return;
    }
    this.parts.stage.classList.remove("empty");
    this.set({ row, intermediate: null });
    this.markVariant();
  }

  /** Shows a picture of what the image is made of; null or the shown one's name shows the image again. */
  async chooseIntermediate(name) {
    const { row } = this;
    const intermediate =
      name === this.intermediate?.name ? null : (intermediatesOf(row).find((one) => one.name === name) ?? null);
    if (intermediate) {
      this.surface.wanted.add(intermediate.index);
      await this.surface.load(intermediate.index);
    }
    if (this.row !== row) return;
    this.set({ intermediate });
    this.markVariant();
  }

  stepIntermediate() {
    const names = [...intermediatesOf(this.row).map(({ name }) => name), null];
    this.chooseIntermediate(names[(names.indexOf(this.intermediate?.name ?? null) + 1) % names.length]);
  }

  /** Another image of the scene; one that differs in these axes alone. */
  step(by, axes = null) {
    const isLike = (row) => !axes || variantLabel(row, axes) === variantLabel(this.row, axes);
    const shown = this.scene.variants.filter((row) => row === this.row || (hasPixels(row) && isLike(row)));
    this.choose(shown[(shown.indexOf(this.row) + by + shown.length) % shown.length]);
  }

  play() {
    const axis = variantAxes.includes("frames") ? "frames" : "samples";
    this.timer = this.timer ? clearInterval(this.timer) : setInterval(() => this.step(1, [axis]), 400);
  }

  /** The same variant in another scene. */
  stepScene(by) {
    const scene = scenes[(scenes.indexOf(this.scene) + by + scenes.length) % scenes.length];
    const label = variantLabel(this.row);
    const same = scene.variants.find((one) => variantLabel(one) === label);
    const row = same ?? scene.variants.find(hasPixels) ?? scene.variants[0];
    keep({ cell: row.cell, run: row.run || "", split: this.split ?? "", zoom: "", x: "", y: "" });
    this.show(current());
  }

  /** The decoded picture on the stage. */
  get texels() {
    return this.surface.images.get(this.intermediate ? this.intermediate.index : this.row?.image);
  }

  fit() {
    const { texels } = this;
    this.place.fit(texels);
    this.fitted = [texels.width, texels.height];
  }

  /** Fits a picture of another size than the last one; the probe stays inside. */
  fitOther() {
    const { texels } = this;
    if (!texels || !this.place.origin) return;
    if (String(this.fitted) === String([texels.width, texels.height])) return;
    this.fit();
    if (this.probed) this.probed = this.inside(this.probed);
  }

  inside(place) {
    return place.map((at, i) => clamp(at, 0, [this.texels.width, this.texels.height][i] - 1));
  }

  /** Fits the canvas to its stage, and the image to the canvas; a place that the reader chose stays in the middle. */
  resize() {
    const { place } = this;
    const middle = place.origin && place.middle;
    if (!this.parts.stage.clientWidth || !fitCanvas(this.canvas, this.parts.stage)) return false;
    if (middle && place.isFitted) this.fit();
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
    this.fit();
    this.set({});
  }

  /** Left edge of the reference, a share of the width; null for pictures without one. */
  get wipe() {
    return this.mode === "image" && !this.intermediate ? this.split : null;
  }

  draw() {
    const reference = this.surface.images.get(this.row.reference);
    const left = this.isHeld && !this.intermediate ? reference : this.texels;
    if (!left || !reference || !this.place.origin) return;
    const { contrast } = this;
    const tone = Number(this.tone === "srgb");
    const look = { mode: MODES.indexOf(this.mode), tone, exposure: 2 ** this.stops, contrast };
    if (this.intermediate) this.surface.drawIntermediate(left, this.place, this.isClipped, look);
    else this.surface.draw(left, reference, this.place, this.wipe, this.isClipped, look);
    this.describe();
    this.probe();
  }

  describeIntermediate() {
    const label = intermediateLabel(this.intermediate);
    showSides(this.parts, label, truthName, null);
    this.canvas.setAttribute(
      "aria-label",
      `${sceneLabel(this.row)}: ${label}. ${intermediateLegend(this.intermediate)}`,
    );
    Object.assign(this.canvas.dataset, { shown: this.intermediate.name, mode: "image" });
  }

  describe() {
    const { row, wipe, isHeld } = this;
    const { scale } = this.place;
    say(this.parts.scale, scale >= 1 ? `${number(scale)}×` : `1/${number(1 / scale)}`);
    if (this.intermediate) return this.describeIntermediate();
    const left = isHeld ? truthName : variantLabel(row);
    showSides(this.parts, left, truthName, wipe);
    const shown = wipe === null ? left : `${left} | ${truthName}`;
    const score = isHeld ? "" : `; ${headline} ${scoreText(row)}`;
    this.canvas.setAttribute("aria-label", `${sceneLabel(row)}: ${shown}, ${this.mode}${score}`);
    Object.assign(this.canvas.dataset, { shown: isHeld ? "reference" : row.cell, mode: this.mode });
    return undefined;
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
      const error =
        value && truth && isCounted ? texelError(value, truth, model.images[row.reference].light_mean) : null;
      return { key: idOf(row), name: variantLabel(row), value, error, isCurrent: !this.isHeld && row === this.row };
    });
    const place = `texel (${this.probed.join(", ")})${this.isPinned ? " · pinned" : ""}`;
    const { intermediate } = this;
    const own = intermediate && {
      ...{ key: intermediate.name, name: intermediateLabel(intermediate), value: at(intermediate.index) },
      ...{ error: null, isCurrent: true },
    };
    // Texels of a table are not pixels of the image.
    const isTable = intermediate && !intermediate.is_attachment;
    const others = isTable ? [] : [...truths, ...lines].map((line) => ({ ...line, isCurrent: !own && line.isCurrent }));
    showProbe(this.parts, place, this.mode === "signed", [own, ...others].filter(Boolean));
  }

  /** A ring with cross hairs around the pinned texel: never smaller than can be seen, and as large as the texel. */
  placeMark() {
    this.parts.mark.hidden = !this.isPinned;
    const ratio = this.canvas.width / (this.parts.stage.clientWidth || 1);
    const { origin, scale } = this.place;
    const side = `${Math.max(14, (scale / ratio) * 1.5)}px`;
    const [left, top] = this.probed.map((at, i) => `${((at + 0.5 - origin[i]) * scale) / ratio}px`);
    Object.assign(this.parts.mark.style, { left, top, width: side, height: side });
  }

  /** Moves the probe by whole texels, pins it, and keeps it in sight. */
  moveProbe(dx, dy) {
    if (!this.place.origin) return;
    this.probed = this.inside([this.probed[0] + dx, this.probed[1] + dy]);
    this.place.reveal(this.probed);
    this.set({ isPinned: true });
    const line = [...this.parts.lines.querySelectorAll(".current > *")].map((cell) => cell.textContent);
    announce(`${this.parts.place.textContent}: ${line.join(" ")}`);
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
    const { handle, stage, out, in: nearer, fit, play } = this.parts;
    play.addEventListener("click", () => this.play());
    out.addEventListener("click", () => this.zoom(1 / 1.5));
    nearer.addEventListener("click", () => this.zoom(1.5));
    fit.addEventListener("click", () => this.refit());
    followHandle(handle, stage, (split) => this.set({ split }));
    // Before the first image is placed there is nothing to draw: `show` fits it.
    new ResizeObserver(() => this.place.origin && this.texels && this.resize() && this.draw()).observe(stage);
  }

  syncControls() {
    const { controls, parts } = this;
    const isImage = this.mode === "image" && !this.intermediate;
    const hasTone = isImage || this.intermediate?.encoding === "radiance";
    const texts = { stops: stopsText(this.stops), contrast: number(Number(this.contrast.toFixed(3))) };
    controls.show({ ...this, at: scenes.indexOf(this.scene), isSplit: this.split !== null }, texts);
    // Errors use linear values, without the tone curve.
    for (const name of ["stops", "tone"]) controls.disable(name, !hasTone);
    controls.disable("contrast", !hasTone || this.tone === "srgb");
    controls.disable("isSplit", !isImage);
    controls.disable("mode", Boolean(this.intermediate));
    controls.disable("isClipped", Boolean(this.intermediate) && !hasTone);
    say(parts.isClippedText, isImage || this.intermediate ? "Mark clipped" : "Mark beyond the range");
    fillErrorLegend(parts.legend, this.intermediate ? "image" : this.mode, true);
  }

  fillVariants() {
    const { parts, scene } = this;
    say(parts.shared, model.runs[this.row.run].shared);
    // Images with a key come first, in the order of the keys; many point sets would bury them otherwise.
    const keyed = keyedVariants(scene);
    const rest = scene.variants.filter((row) => !keyed.includes(row));
    const item = (row, name) => {
      const marks = { type: "button", class: "variant", "data-cell": row.cell, "data-run": row.run };
      const label = h("span", { class: inkOf(row), title: variantCode(row) }, variantLabel(row));
      const score = h("span", { class: "score" }, scoreText(row));
      return h("li", {}, h("button", { ...marks, onclick: () => this.choose(row) }, h("kbd", {}, name), label, score));
    };
    parts.variants.replaceChildren(...[...keyed, ...rest].map((row, i) => item(row, keyed[i] ? String(i + 1) : "·")));
    this.markVariant();
  }

  markVariant() {
    const { row, parts } = this;
    for (const button of parts.variants.querySelectorAll("button")) {
      const isShown = !this.intermediate && button.dataset.cell === row.cell && Number(button.dataset.run) === row.run;
      button.setAttribute("aria-pressed", String(isShown));
    }
    fillIntermediates(parts.intermediates, row, (name) => this.chooseIntermediate(name));
    markIntermediate(parts.intermediates, this.intermediate?.name ?? null);
    if (this.intermediate) return this.announceIntermediate();
    const image = model.images[row.image];
    const exr = image ? exrLink(row.image) : null;
    parts.exr.hidden = !exr;
    if (exr) parts.exr.href = exr;
    const count = image?.clamped_count ?? 0;
    if (image) say(parts.caption, count > 0 ? `${count} channels above 65504 are stored as 65504` : "");
    announce(`${sceneLabel(row)}: ${variantLabel(row)}, ${headline} ${scoreText(row)}`);
    return undefined;
  }

  announceIntermediate() {
    this.parts.exr.hidden = true;
    say(this.parts.caption, intermediateLegend(this.intermediate));
    announce(`${sceneLabel(this.row)}: ${intermediateLabel(this.intermediate)}`);
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
  // Controls without a picture would do nothing.
  if (!hasPixels(firstRow() ?? { image: null })) {
    const why = `There is nothing to compare: this page holds no images. ${model.image_notes.join(" ")}`;
    const title = h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Compare"));
    const link = model.images.length ? h("a", { href: "#images" }, "Links to the linear EXR files") : "";
    return view.replaceChildren(title, h("p", { class: "note", role: "status" }, why), link);
  }
  viewer ??= new Viewer(view);
  return viewer.show(state);
}
export const viewerKey = (event) => (viewer ? key(viewer, event) : false);
export const viewerRelease = () => viewer?.hold(false);
