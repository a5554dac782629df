// The comparison of images on linear data: flip in place, split, zoom to texels, error maps, probe. WebGL2.

import {
  HALF,
  exrLink,
  hasPixels,
  headline,
  idOf,
  model,
  rowOf,
  rows,
  sceneLabel,
  scenes,
  texelError,
  truthName,
  variantLabel,
} from "report/data";
import { announce, choice, h, number, say, scrollBox, select, slider, stopsText, tableHead } from "report/dom";
import { errorCell, errorHead, fillErrorLegend } from "report/legend";
import { fitCanvas, linkButton } from "report/stage";
import { keep, state as current } from "report/state";
import { Surface } from "report/surface";
import { STOPS, key, keyedVariants, listen } from "report/viewer-input";

const SCALE_MAX = 96;
/** What the slider reaches, and so what an address may ask for. */
const CONTRAST = [0.1, 5];
const MODES = [
  ["image", "Image", "the image through the tone curve"],
  ["error", "Error", "relative error (E)"],
  ["signed", "Signed", "signed relative error (S)"],
];
const TONES = [
  ["curve", "Tone curve", "(e L / (e L + 1))^(contrast / 2.2), the project's"],
  ["srgb", "sRGB", "clipped linear, sRGB-encoded"],
];

class Viewer {
  constructor(view) {
    this.view = view;
    this.showsReference = false;
    this.canvas = h("canvas", { tabindex: 0, role: "img", "aria-describedby": "viewer-keys" });
    this.surface = new Surface(this.canvas, () => this.show(current()));
    this.build();
  }

  // --- State ---------------------------------------------------------------------------------------------------------------

  /** Shows what the address asks for. */
  async show(state) {
    const row = rowOf(state.cell, state.run ?? 0) ?? scenes.flatMap((one) => one.variants).find(hasPixels) ?? rows[0];
    if (!row || !this.surface.gl) return this.sayNothing(row);
    const scene = row.scene,
      real = (text, lo, hi, otherwise) =>
        text !== undefined && text !== "" && Number.isFinite(Number(text))
          ? Math.min(hi, Math.max(lo, Number(text)))
          : otherwise;
    this.row = row.original;
    this.other = scene.variants.find((v) => idOf(v) === state.with) ?? null;
    this.mode = MODES.some(([name]) => name === state.mode) ? state.mode : "image";
    this.tone = state.tone === "srgb" ? "srgb" : "curve";
    this.stops = real(state.ev, ...STOPS, Math.log2(Number(row.axes.exposure) || 1));
    this.contrast = real(state.contrast, ...CONTRAST, Number(row.axes.contrast) || 1);
    this.clipped = state.clip === "1";
    this.split = state.split === undefined ? null : real(state.split, 0, 1, 0.5);
    const isNew = this.scene !== scene;
    this.scene = scene;
    this.surface.wanted = new Set(scene.variants.flatMap((v) => [v.image, v.reference]).filter((i) => i !== null));
    this.fillVariants();
    this.syncControls();
    const needed = [
      this.row.image,
      this.row.reference,
      this.other?.image ?? null,
      this.other?.reference ?? null,
    ].filter((i) => i !== null);
    await Promise.all(needed.map((i) => this.surface.load(i)));
    if (this.scene !== scene) return undefined;
    const texels = this.surface.images.get(this.row.image);
    if (!texels) return this.sayNothing(row);
    const { window } = model.images[this.row.image],
      pin = state.texel?.match(/^(\d+),(\d+)$/);
    this.pinned = Boolean(pin);
    if (pin)
      this.probed = [
        Math.min(texels.width - 1, Math.max(0, pin[1] - window.x)),
        Math.min(texels.height - 1, Math.max(0, pin[2] - window.y)),
      ];
    // Without a pointer the probe starts in the middle.
    this.probed ??= [texels.width >> 1, texels.height >> 1];
    this.stage.classList.remove("empty");
    this.resize();
    if (isNew || !this.origin) this.fit();
    if (state.zoom !== undefined) {
      this.isFitted = false;
      this.scale = real(state.zoom, Math.min(this.fitScale, 1) / 2, SCALE_MAX, 1);
      this.center(real(state.x, 0, texels.width, texels.width / 2), real(state.y, 0, texels.height, texels.height / 2));
    }
    this.draw();
    // The rest of the scene, so that flipping and the probe are instant.
    for (const index of this.surface.wanted) await this.surface.load(index);
    this.canvas.dataset.ready = scene.key;
    this.probe();
    return undefined;
  }

  sayNothing(row) {
    this.stage.classList.add("empty");
    // The next picture is fitted anew.
    this.origin = undefined;
    const failure = model.runs[row.run].failures.find((one) => one.cell === row.cell);
    const why = !this.surface.gl
      ? "This browser has no WebGL2, which the comparison needs."
      : failure
        ? `This cell failed: ${failure.reason}`
        : "No pixels of this cell are in the page.";
    this.canvas.setAttribute("aria-label", `${sceneLabel(row)}: ${variantLabel(row)}. ${why}`);
    this.canvas.dataset.shown = row.cell;
    this.mark.hidden = true;
    this.caption.replaceChildren(
      why,
      " ",
      row?.image != null ? h("a", { href: exrLink(row.image) }, "Its linear EXR") : "",
    );
  }

  keepState() {
    const texels = this.surface.images.get(this.row.image);
    const isOwn = texels && !this.isFitted,
      middle = isOwn ? this.middle() : {};
    keep({
      cell: this.row.cell,
      run: this.row.run || "",
      with: this.other ? idOf(this.other) : "",
      mode: this.mode === "image" ? "" : this.mode,
      tone: this.tone === "curve" ? "" : this.tone,
      ev: Number(this.stops.toFixed(3)),
      contrast: Number(this.contrast.toFixed(3)),
      clip: this.clipped ? "1" : "",
      split: this.split === null ? "" : Number(this.split.toFixed(4)),
      texel: this.pinned ? this.texelName().join(",") : "",
      zoom: isOwn ? Number(this.scale.toFixed(3)) : "",
      x: middle.x ?? "",
      y: middle.y ?? "",
    });
  }

  choose(row) {
    if (!this.surface.images.has(row.image) || !this.origin) {
      keep({ cell: row.cell, run: row.run || "" });
      this.show(current());
      return;
    }
    this.row = row;
    this.stage.classList.remove("empty");
    this.draw();
    this.keepState();
    this.markVariant();
  }

  step(by) {
    const shown = this.scene.variants.filter((row) => hasPixels(row) || row === this.row);
    this.choose(shown[(shown.indexOf(this.row) + by + shown.length) % shown.length]);
  }

  /** The same variant in the next scene, beside the same one. */
  stepScene(by) {
    const scene = scenes[(scenes.indexOf(this.scene) + by + scenes.length) % scenes.length];
    const label = variantLabel(this.row);
    const row =
      scene.variants.find((v) => variantLabel(v) === label) ?? scene.variants.find(hasPixels) ?? scene.variants[0];
    const other =
      this.other && scene.variants.find((v) => hasPixels(v) && variantLabel(v) === variantLabel(this.other));
    keep({ cell: row.cell, run: row.run || "", with: other ? idOf(other) : "", zoom: "", x: "", y: "" });
    this.show(current());
  }

  // --- Place ---------------------------------------------------------------------------------------------------------------

  /** Whole texels per canvas pixel where the image is smaller than the canvas: no texel is wider than its neighbour. */
  fit() {
    const texels = this.surface.images.get(this.row.image);
    if (!texels) return;
    const scale = Math.min(this.canvas.width / texels.width, this.canvas.height / texels.height);
    this.scale = this.fitScale = scale >= 1 ? Math.floor(scale) : scale;
    this.isFitted = true;
    this.center(texels.width / 2, texels.height / 2);
  }

  center(x, y) {
    this.origin = [x - this.canvas.width / 2 / this.scale, y - this.canvas.height / 2 / this.scale];
    if (this.scale >= 1) this.origin = this.origin.map((value) => Math.round(value * this.scale) / this.scale);
  }

  /** Fits the canvas to its stage, and the image to the canvas, unless the reader has chosen a place himself: then its middle stays. */
  resize() {
    if (!this.stage.clientWidth) return false;
    const middle = this.origin && this.middle();
    if (!fitCanvas(this.canvas, this.stage)) return false;
    if (middle && this.isFitted) this.fit();
    else if (middle) this.center(middle.x, middle.y);
    return true;
  }

  middle() {
    const round = (value) => Number(value.toFixed(2));
    return {
      x: round(this.origin[0] + this.canvas.width / 2 / this.scale),
      y: round(this.origin[1] + this.canvas.height / 2 / this.scale),
    };
  }

  /** Zooms by `factor` and leaves the texel under canvas pixel (x, y) where it is. */
  zoom(factor, x = this.canvas.width / 2, y = this.canvas.height / 2) {
    if (!this.origin) return;
    let scale = Math.min(SCALE_MAX, Math.max(Math.min(this.fitScale, 1) / 2, this.scale * factor));
    if (scale > 1) scale = factor > 1 ? Math.ceil(scale - 1e-6) : Math.floor(scale + 1e-6);
    const texel = [this.origin[0] + x / this.scale, this.origin[1] + y / this.scale];
    this.scale = scale;
    this.isFitted = false;
    this.origin = [texel[0] - x / scale, texel[1] - y / scale];
    this.draw();
    this.keepState();
  }

  pan(dx, dy) {
    if (!this.origin) return;
    this.isFitted = false;
    this.origin = [this.origin[0] - dx / this.scale, this.origin[1] - dy / this.scale];
    this.draw();
  }

  // --- Drawing -------------------------------------------------------------------------------------------------------------

  draw() {
    const { images } = this.surface,
      reference = images.get(this.row.reference);
    const left = this.showsReference ? reference : images.get(this.row.image);
    if (!left || !reference || !this.origin) return;
    const isSplit = this.split !== null,
      rightRow = this.other ?? this.row;
    this.surface.draw({
      left,
      reference,
      right: isSplit ? ((this.other ? images.get(this.other.image) : reference) ?? reference) : left,
      rightReference: (isSplit ? images.get(rightRow.reference) : null) ?? reference,
      origin: this.origin,
      scale: this.scale,
      split: isSplit ? this.split : null,
      mode: MODES.findIndex(([name]) => name === this.mode),
      tone: this.tone === "srgb" ? 1 : 0,
      exposure: 2 ** this.stops,
      contrast: this.contrast,
      clipped: this.clipped,
    });
    this.describe(isSplit);
    this.probe();
  }

  describe(isSplit) {
    const { row, other } = this;
    const name = this.showsReference ? truthName : variantLabel(row);
    const error = row.scores[headline];
    const what = {
      image: this.tone === "srgb" ? "sRGB" : "tone curve",
      error: "relative error",
      signed: "signed error",
    }[this.mode];
    const right = other ? variantLabel(other) : truthName,
      text = `${name}${isSplit ? ` | ${right}` : ""}`;
    this.badge.textContent = name;
    this.badge.classList.toggle("is-reference", this.showsReference);
    this.rightBadge.textContent = right;
    this.rightBadge.classList.toggle("is-reference", !other);
    this.rightBadge.hidden = !isSplit;
    this.canvas.setAttribute(
      "aria-label",
      `${this.scene.label}: ${text}, ${what}${this.showsReference ? "" : `; relMSE ${number(error)}`}`,
    );
    this.canvas.dataset.shown = this.showsReference ? "reference" : row.cell;
    this.canvas.dataset.mode = this.mode;
    say(this.scaleText, this.scale >= 1 ? `${number(this.scale)}×` : `1/${number(1 / this.scale)}`);
    this.handle.hidden = !isSplit;
    if (isSplit) this.handle.style.left = `${this.split * 100}%`;
    this.handle.setAttribute("aria-valuenow", isSplit ? Math.round(this.split * 100) : 0);
    this.clipText.textContent = this.mode === "image" ? " Mark clipped" : " Mark beyond the range";
    this.legend.hidden = this.mode === "image";
    if (this.legend.dataset.mode !== this.mode) this.fillLegend();
  }

  fillLegend() {
    this.legend.dataset.mode = this.mode;
    if (this.mode === "image") return;
    fillErrorLegend(this.legend, this.mode === "signed", true);
  }

  // --- Probe ---------------------------------------------------------------------------------------------------------------

  texelAt(event) {
    const box = this.canvas.getBoundingClientRect(),
      ratio = this.canvas.width / box.width;
    const [x, y] = [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
    return [Math.floor(this.origin[0] + x / this.scale), Math.floor(this.origin[1] + y / this.scale)];
  }

  /** The probed texel in the whole image, of which the page may hold a window. */
  texelName() {
    const { x, y } = model.images[this.row.image]?.window ?? { x: 0, y: 0 };
    return [this.probed[0] + x, this.probed[1] + y];
  }

  /** Every variant's linear values at the probed texel. */
  probe() {
    if (!this.scene || !this.probed || !this.origin) return;
    const [x, y] = this.probed;
    const at = (index) => {
      const entry = this.surface.images.get(index);
      if (!entry || x < 0 || y < 0 || x >= entry.width || y >= entry.height) return null;
      return [0, 1, 2].map((c) => HALF[entry.rgba[4 * (y * entry.width + x) + c]]);
    };
    this.placeMark(x, y);
    say(
      this.probePlace,
      model.images[this.row.image]?.window
        ? `texel (${this.texelName().join(", ")})${this.pinned ? " · pinned" : ""}`
        : "",
    );
    // A flip changes nothing but which of the lines is the current one.
    const read = [this.scene.key, this.mode === "signed", x, y, ...this.surface.images.keys()].join(" ");
    if (read !== this.read) this.readTexel(x, y, at);
    this.read = read;
    for (const one of this.probeBody.children) one.classList.toggle("current", one.dataset.probe === idOf(this.row));
  }

  /** Writes the values of a texel, a line an image. What has no pixels here has none. */
  readTexel(x, y, at) {
    const isSigned = this.mode === "signed",
      line = (name, key, value, error) =>
        h(
          "tr",
          { "data-probe": key },
          h("th", { scope: "row" }, name),
          (value ?? [null, null, null]).map((v) =>
            h("td", { "data-value": v ?? "", title: v === null ? "" : String(v) }, number(v, 4)),
          ),
          errorCell(error, isSigned),
        );
    say(this.probeBody.parentElement.querySelector("th:last-child"), errorHead(isSigned));
    const references = new Map();
    const lines = this.scene.variants
      .filter((row) => hasPixels(row))
      .map((row) => {
        const [value, truth] = [at(row.image), at(row.reference)];
        if (!references.has(row.reference)) references.set(row.reference, truth);
        const bytes = this.surface.images.get(row.reference)?.maskBytes,
          width = this.surface.images.get(row.reference)?.width;
        const counts = !bytes || bytes[y * width + x] === 1;
        return line(variantLabel(row), idOf(row), value, value && truth && counts ? texelError(value, truth) : null);
      });
    this.probeBody.replaceChildren(
      ...[...references].map(([index, truth], i) =>
        line(`${truthName}${references.size > 1 ? ` ${i + 1}` : ""}`, `reference-${index}`, truth, null),
      ),
      ...lines,
    );
  }

  /** A ring with cross hairs around the pinned texel: never smaller than can be seen, and as large as the texel. */
  placeMark(x, y) {
    this.mark.hidden = !this.pinned;
    if (!this.pinned) return;
    const ratio = this.canvas.width / (this.stage.clientWidth || 1),
      side = Math.max(14, (this.scale / ratio) * 1.5);
    const [left, top] = [x, y].map((at, i) => ((at + 0.5 - this.origin[i]) * this.scale) / ratio);
    Object.assign(this.mark.style, { left: `${left}px`, top: `${top}px`, width: `${side}px`, height: `${side}px` });
  }

  /** Moves the probe by whole texels, pins it, and keeps it in sight. */
  moveProbe(dx, dy) {
    if (!this.origin) return;
    const { width, height } = this.surface.images.get(this.row.image);
    this.probed = [this.probed[0] + dx, this.probed[1] + dy].map((at, i) =>
      Math.min([width, height][i] - 1, Math.max(0, at)),
    );
    this.pinned = true;
    const place = this.probed.map((at, i) => (at + 0.5 - this.origin[i]) * this.scale),
      { canvas } = this;
    if (place[0] < 0 || place[1] < 0 || place[0] > canvas.width || place[1] > canvas.height) {
      this.isFitted = false;
      this.center(this.probed[0] + 0.5, this.probed[1] + 0.5);
    }
    this.draw();
    this.keepState();
    const line = this.probeBody.querySelector(".current");
    if (line)
      announce(`${this.probePlace.textContent}: ${[...line.children].map((cell) => cell.textContent).join(" ")}`);
  }

  // --- Controls ------------------------------------------------------------------------------------------------------------

  build() {
    this.exposure = slider("Exposure", ...STOPS, 0.1, "exposure", (stops) => {
      this.stops = stops;
      this.redraw();
    });
    this.contrastSlider = slider("Contrast", ...CONTRAST, 0.05, "contrast", (value) => {
      this.contrast = value;
      this.redraw();
    });
    this.modeChoice = choice("What is shown", MODES, "image", (mode) => {
      this.mode = mode;
      this.redraw();
    });
    this.toneChoice = choice("Tone", TONES, "curve", (tone) => {
      this.tone = tone;
      this.redraw();
    });
    this.clipBox = h("input", {
      type: "checkbox",
      onchange: () => {
        this.clipped = this.clipBox.checked;
        this.redraw();
      },
    });
    this.clipText = h("span", {}, " Mark clipped");
    this.splitBox = h("input", { type: "checkbox", onchange: () => this.setSplit(this.splitBox.checked ? 0.5 : null) });
    this.badge = h("p", { class: "badge" });
    this.rightBadge = h("p", { class: "badge right", hidden: true });
    this.scaleText = h("span", { class: "scale-text" });
    this.legend = h("div", { class: "error-legend", hidden: true });
    this.mark = h("i", { class: "probe-mark", "aria-hidden": "true", hidden: true });
    this.caption = h("p", { class: "caption" });
    this.handle = h("div", {
      class: "split-handle",
      role: "slider",
      tabindex: 0,
      "aria-label": "Split",
      "aria-valuemin": 0,
      "aria-valuemax": 100,
      hidden: true,
    });
    this.stage = h(
      "div",
      { class: "viewer-stage" },
      this.canvas,
      this.mark,
      this.badge,
      this.rightBadge,
      this.handle,
      h(
        "div",
        { class: "zoom-tools" },
        h(
          "button",
          { type: "button", title: "Zoom out (−)", "aria-label": "Zoom out", onclick: () => this.zoom(1 / 1.5) },
          "−",
        ),
        this.scaleText,
        h(
          "button",
          { type: "button", title: "Zoom in (+)", "aria-label": "Zoom in", onclick: () => this.zoom(1.5) },
          "+",
        ),
        h(
          "button",
          {
            type: "button",
            title: "Fit (0)",
            onclick: () => {
              this.fit();
              this.draw();
              this.keepState();
            },
          },
          "Fit",
        ),
      ),
      this.caption,
    );
    this.variants = h("ol", { class: "variants", "aria-label": "Images of this scene" });
    this.scenePicker = h("span", {});
    this.withPicker = h("span", {});
    this.probePlace = h("span", {});
    this.probeBody = h("tbody", {});
    const panel = h(
      "aside",
      { class: "panel", "aria-label": "Controls" },
      h("div", { class: "row" }, this.scenePicker),
      this.variants,
      h("div", { class: "row" }, this.modeChoice, this.toneChoice),
      this.legend,
      this.exposure.element,
      this.contrastSlider.element,
      h(
        "div",
        { class: "row checks" },
        h("label", {}, this.splitBox, " Split with "),
        this.withPicker,
        h("label", {}, this.clipBox, this.clipText),
      ),
      h(
        "section",
        { class: "probe", "aria-label": "Probe" },
        h("h2", {}, "Linear values ", this.probePlace),
        scrollBox("Linear values", h("table", {}, tableHead(["", "R", "G", "B", "error"], "image"), this.probeBody)),
        h(
          "p",
          { class: "note" },
          "Half floats: 11 significant bits. Click the image to pin the texel, shift and arrows move it.",
        ),
      ),
      h(
        "div",
        { class: "row" },
        linkButton(() => this.row && this.keepState()),
        (this.exr = h("a", {}, "EXR")),
      ),
      h(
        "p",
        { class: "note keys", id: "viewer-keys" },
        h("kbd", {}, "1"),
        "–",
        h("kbd", {}, "9"),
        " image · hold ",
        h("kbd", {}, "space"),
        " reference · ",
        h("kbd", {}, "E"),
        " error · ",
        h("kbd", {}, "S"),
        " signed · ",
        h("kbd", {}, "?"),
        " all keys",
      ),
    );
    this.view.replaceChildren(
      h("h1", { class: "visually-hidden" }, "Compare"),
      h("div", { class: "viewer" }, this.stage, panel),
    );
    listen(this);
    new ResizeObserver(() => {
      // Before the first image is placed there is nothing to draw: `show` fits it.
      if (this.origin && this.surface.images.has(this.row.image) && this.resize()) this.draw();
    }).observe(this.stage);
  }

  redraw() {
    this.syncControls();
    this.draw();
    this.keepState();
  }

  setSplit(split) {
    this.split = split;
    this.redraw();
  }

  syncControls() {
    this.exposure.input.value = this.stops;
    this.exposure.output.textContent = stopsText(this.stops);
    this.contrastSlider.input.value = this.contrast;
    this.contrastSlider.output.textContent = number(Number(this.contrast.toFixed(3)));
    // Errors are of linear values: no tone curve reaches them.
    const isImage = this.mode === "image";
    this.exposure.input.disabled = !isImage;
    this.contrastSlider.input.disabled = !isImage || this.tone === "srgb";
    for (const button of this.toneChoice.children) button.disabled = !isImage;
    this.modeChoice.press(this.mode);
    this.toneChoice.press(this.tone);
    this.clipBox.checked = this.clipped;
    this.splitBox.checked = this.split !== null;
  }

  fillVariants() {
    this.scenePicker.replaceChildren(
      select(
        "Scene",
        scenes.map((one, i) => [i, one.label]),
        scenes.indexOf(this.scene),
        (index) => this.stepScene(Number(index) - scenes.indexOf(this.scene)),
      ),
    );
    this.withPicker.replaceChildren(
      select(
        "",
        [["", truthName], ...this.scene.variants.filter(hasPixels).map((v) => [idOf(v), variantLabel(v)])],
        this.other ? idOf(this.other) : "",
        async (id) => {
          this.other = this.scene.variants.find((v) => idOf(v) === id) ?? null;
          if (this.other)
            await Promise.all([this.surface.load(this.other.image), this.surface.load(this.other.reference)]);
          this.setSplit(this.split ?? 0.5);
        },
      ),
    );
    this.withPicker.querySelector("select").setAttribute("aria-label", "Split with");
    // What has a key stands first, in the order of the keys; of many point sets the rest would bury it.
    const keyed = keyedVariants(this.scene),
      rest = this.scene.variants.filter((row) => !keyed.includes(row));
    const item = (row, key) =>
      h(
        "li",
        {},
        h(
          "button",
          {
            type: "button",
            "data-cell": row.cell,
            "data-run": row.run,
            onclick: () => this.choose(row),
            class: "variant",
          },
          h("kbd", {}, key),
          h("span", {}, variantLabel(row)),
          h("span", { class: "score" }, row.scores[headline] === null ? "failed" : number(row.scores[headline])),
        ),
      );
    this.variants.replaceChildren(
      ...keyed.map((row, i) => item(row, String(i + 1))),
      ...(keyed.length && rest.length
        ? [
            h(
              "li",
              {},
              h(
                "details",
                { open: rest.includes(this.row) },
                h("summary", {}, `${rest.length} more without a key`),
                h(
                  "ol",
                  { class: "variants" },
                  rest.map((row) => item(row, "·")),
                ),
              ),
            ),
          ]
        : rest.map((row) => item(row, "·"))),
    );
    this.markVariant();
  }

  markVariant() {
    for (const button of this.variants.querySelectorAll("button"))
      button.setAttribute(
        "aria-pressed",
        String(button.dataset.cell === this.row.cell && Number(button.dataset.run) === this.row.run),
      );
    const image = model.images[this.row.image];
    this.exr.hidden = !image;
    if (image) {
      this.exr.href = exrLink(this.row.image);
      say(this.exr, "Linear EXR");
      const { window, size, clamped_count: clampedCount } = image;
      const cut = window && (window.width !== size[0] || window.height !== size[1]);
      say(
        this.caption,
        [
          cut
            ? `window ${window.width} × ${window.height} at (${window.x}, ${window.y}) of ${size[0]} × ${size[1]}`
            : "",
          clampedCount ? `${clampedCount} channels above 65504 are stored as 65504` : "",
        ]
          .filter(Boolean)
          .join("; "),
      );
    }
    announce(
      `${this.scene.label}: ${variantLabel(this.row)}, ${this.row.scores[headline] === null ? "failed" : `relMSE ${number(this.row.scores[headline])}`}`,
    );
  }

  // --- Reference ------------------------------------------------------------------------------------------------------------

  /** Shows the reference while a key is down. */
  hold(isHeld) {
    if (this.showsReference === isHeld || !this.row) return;
    this.showsReference = isHeld;
    this.draw();
  }
}

let viewer = null;
export function showViewer(view, state) {
  if (!rows.length) return view.replaceChildren(h("p", { class: "note" }, "No cell is done."));
  // Controls without a picture would do nothing.
  if (!rows.some(hasPixels)) {
    return view.replaceChildren(
      h("div", { class: "controls" }, h("h1", { tabindex: -1 }, "Compare")),
      h(
        "p",
        { class: "note", role: "status" },
        `There is nothing to compare: this page holds no images. ${model.image_notes.join(" ")}`,
      ),
      h("p", {}, h("a", { href: "#images" }, "Links to the linear EXR files")),
    );
  }
  viewer ??= new Viewer(view);
  return viewer.show(state);
}
export const viewerKey = (event) => (viewer ? key(viewer, event) : false);
export const viewerRelease = () => viewer?.hold(false);
