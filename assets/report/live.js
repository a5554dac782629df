// The live material view: a sphere and a plane lit by the run's own tables, shaded by the renderer's shaders, split sum against samples.

import { lightTables, rows, texelError } from "report/data";
import { announce, byId, choice, h, number, say, select, slider, stopsText, scrollBox, tableHead } from "report/dom";
import { errorCell, errorHead, fillErrorLegend } from "report/legend";
import { LiveRender, MODES, OBJECTS } from "report/live-render";
import { keepContext } from "report/program";
import { fitCanvas, linkButton } from "report/stage";
import { keep, state as current } from "report/state";

const MODE_CHOICES = [
  ["split", "Split sum", "one lookup each in the prefiltered map and the DFG table (1)"],
  ["sampled", "Sampled", "importance sampling at every pixel (2)"],
  ["error", "Error", "relative error of the split sum against the samples (3)"],
  ["signed", "Signed", "signed relative error (4)"],
];
const MODE_NAMES = {
  split: "split sum",
  sampled: "sampled",
  error: "relative error of the split sum",
  signed: "signed error of the split sum",
};
const OBJECT_CHOICES = [
  ["both", "Both"],
  ["sphere", "Sphere"],
  ["plane", "Plane"],
];
const PITCH_MAX = 88,
  DISTANCE = [0.4, 3];
/** The sliders' ends; those of the axis `lod_bias` are wider. */
const ROTATION_MAX = 360,
  BIAS_MAX = 16,
  BIAS_SLIDER = 4;
/** After this long without a change, ms, the view is at rest: it is drawn with every pixel, and its address is kept. */
const REST_MS = 180;

const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));
const round = (x, digits) => Number(x.toFixed(digits));

class Live {
  constructor(view) {
    this.view = view;
    this.tables = lightTables();
    this.canvas = h("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": "Live material view",
      "aria-describedby": "live-keys",
    });
    this.render = new LiveRender(this.canvas);
    this.held = false;
    this.changed = -Infinity;
    this.build();
    keepContext(this.canvas, () => {
      this.render.reset();
      this.apply();
    });
  }

  // --- State ---------------------------------------------------------------------------------------------------------------

  defaults() {
    const { tables } = this,
      { albedo, f0 } = tables.material;
    // The light and the level bias are those of the run, the first of those it tried.
    const [rotation, bias] = ["environment_rotation_deg", "lod_bias"].map((name) =>
      Number(rows.find((row) => row.axes[name])?.axes[name] ?? 0),
    );
    return {
      environment: 0,
      rotation,
      bias,
      brdf: tables.lobes[0].brdf,
      masking: tables.lobes[0].masking,
      object: "both",
      albedo: [albedo, albedo, albedo],
      metallic: 1,
      f0,
      roughness: 0.4,
      diffuse: true,
      brightness: 1,
      stops: 0,
      contrast: 1,
      mode: "split",
      samples: 64,
      filtered: true,
      yaw: 25,
      pitch: 14,
      distance: 1.2,
    };
  }

  /** The settings that the address asks for; what it does not name, or names wrongly, is the default. */
  read(state) {
    const start = this.defaults(),
      { tables } = this;
    const real = (text, lo, hi, otherwise) =>
      text !== undefined && text !== "" && Number.isFinite(Number(text)) ? clamp(Number(text), lo, hi) : otherwise;
    const one = (text, values, otherwise) => (values.includes(text) ? text : otherwise);
    const brdf = one(
        state.brdf,
        tables.lobes.map((lobe) => lobe.brdf),
        start.brdf,
      ),
      own = tables.lobes.filter((lobe) => lobe.brdf === brdf).map((lobe) => lobe.masking);
    const albedo = (state.albedo ?? "").split(",");
    const wanted = real(state.n, 1, Infinity, start.samples);
    return {
      environment: Math.trunc(real(state.env, 0, tables.environments.length - 1, 0)),
      brdf,
      rotation: real(state.turn, -ROTATION_MAX, ROTATION_MAX, start.rotation),
      bias: real(state.bias, -BIAS_MAX, BIAS_MAX, start.bias),
      masking: one(state.masking, own, own[0]),
      object: one(state.object, Object.keys(OBJECTS), start.object),
      albedo: start.albedo.map((otherwise, c) => real(albedo[c], 0, 1, otherwise)),
      metallic: real(state.metallic, 0, 1, start.metallic),
      f0: real(state.f0, 0, 1, start.f0),
      roughness: real(state.roughness, 0, 1, start.roughness),
      diffuse: state.diffuse !== "0",
      brightness: real(state.brightness, 0, 100, start.brightness),
      stops: real(state.ev, -12, 12, start.stops),
      contrast: real(state.contrast, 0.1, 5, start.contrast),
      mode: one(state.mode, MODES, start.mode),
      filtered: state.filter !== "0",
      samples: this.counts.reduce((best, count) => (Math.abs(count - wanted) < Math.abs(best - wanted) ? count : best)),
      yaw: real(state.yaw, -360, 360, start.yaw),
      pitch: real(state.pitch, -PITCH_MAX, PITCH_MAX, start.pitch),
      distance: real(state.distance, ...DISTANCE, start.distance),
    };
  }

  keepState() {
    const { settings: s } = this,
      start = this.defaults();
    this.isUnkept = false;
    // Only what differs from the start is written.
    const given = (value, otherwise) => (String(value) === String(otherwise) ? "" : value);
    if (current().view !== "live") return;
    keep({
      env: given(s.environment, 0),
      turn: given(round(s.rotation, 2), round(start.rotation, 2)),
      bias: given(round(s.bias, 4), round(start.bias, 4)),
      brdf: given(s.brdf, start.brdf),
      masking: given(s.masking, start.masking),
      object: given(s.object, start.object),
      albedo: given(s.albedo.map((x) => round(x, 3)).join(","), start.albedo.map((x) => round(x, 3)).join(",")),
      metallic: given(round(s.metallic, 3), start.metallic),
      f0: given(round(s.f0, 3), round(start.f0, 3)),
      roughness: given(round(s.roughness, 3), start.roughness),
      diffuse: s.diffuse ? "" : "0",
      brightness: given(round(s.brightness, 3), start.brightness),
      ev: given(round(s.stops, 2), start.stops),
      contrast: given(round(s.contrast, 2), start.contrast),
      mode: given(s.mode, start.mode),
      n: given(s.samples, start.samples),
      filter: s.filtered ? "" : "0",
      yaw: given(round(s.yaw, 1), start.yaw),
      pitch: given(round(s.pitch, 1), start.pitch),
      distance: given(round(s.distance, 2), start.distance),
    });
  }

  show(state) {
    this.settings = this.read(state);
    return this.apply();
  }

  /** Draws the settings anew: after anything that changes shading. */
  async apply() {
    this.changed = performance.now();
    this.syncControls();
    fitCanvas(this.canvas, this.stage);
    if (await this.render.show({ ...this.settings, mode: this.shownMode() })) this.loop();
  }

  /** Changes settings; only mode and tone curve leave the shading alone. */
  set(details) {
    Object.assign(this.settings, details);
    this.isUnkept = true;
    if (!Object.keys(details).every((name) => ["mode", "stops", "contrast"].includes(name))) return this.apply();
    this.changed = performance.now();
    this.syncControls();
    this.render.display({ ...details, mode: this.shownMode() });
    this.loop();
    return undefined;
  }

  shownMode() {
    const { mode } = this.settings;
    return this.held ? (mode === "sampled" ? "split" : "sampled") : mode;
  }

  turn(yaw, pitch) {
    const { settings: s } = this;
    const turned = ((((s.yaw + yaw + 180) % 360) + 360) % 360) - 180;
    this.set({ yaw: turned, pitch: clamp(s.pitch + pitch, -PITCH_MAX, PITCH_MAX) });
  }

  // --- Drawing -------------------------------------------------------------------------------------------------------------

  loop() {
    this.canvas.dataset.ready = "";
    this.canvas.dataset.relmse = "";
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      if (byId("view-live").hidden || !this.render.view || this.render.gl.isContextLost()) return;
      // Where a frame takes long, changes come no faster than frames.
      const rested = performance.now() - this.changed > Math.max(REST_MS, 2 * this.render.frameMs);
      const drawn = this.render.step(!rested);
      if (rested && this.isUnkept) this.keepState();
      this.describe();
      if (drawn && !(this.render.isComplete && rested)) this.probe();
      if (drawn && this.render.isComplete && rested) this.finish();
      else this.loop();
    });
  }

  /** All samples are there. */
  finish() {
    const { render } = this;
    this.total = render.isSampling ? render.relativeError((t, r) => texelError(t, r).relative ** 2) : null;
    this.canvas.dataset.ready = "1";
    this.canvas.dataset.relmse = this.total ?? "";
    this.describe();
    this.probe();
  }

  describe() {
    const { settings: s, render } = this,
      mode = this.shownMode(),
      isDone = this.canvas.dataset.ready === "1";
    // Until all samples are in the frame, it is an estimate by the first of them.
    const counted =
      render.done < s.samples ? `${render.done} of ${s.samples} samples a pixel` : `${s.samples} samples a pixel`;
    const what =
      mode === "split"
        ? "split sum"
        : mode === "sampled"
          ? `sampled, ${counted}`
          : `split sum against ${counted}${mode === "signed" ? ", signed" : ""}`;
    this.badge.textContent = what;
    const share = render.isSampling ? render.done / s.samples : 1;
    this.progress.hidden = share >= 1;
    this.progress.value = share;
    this.score.textContent = !render.isSampling ? "–" : isDone ? number(this.total) : "…";
    this.canvas.dataset.mode = mode;
    const { label } = this.tables.environments[s.environment];
    const material = `${s.brdf}, roughness ${number(s.roughness)}, metallic ${number(s.metallic)}`;
    if (isDone) {
      this.canvas.setAttribute(
        "aria-label",
        `${{ both: "Sphere and plane", sphere: "Sphere", plane: "Plane" }[s.object]} in ${label}, ${material}; ${what}${render.isSampling ? `; relMSE ${number(this.total)}` : ""}`,
      );
    }
  }

  /** The linear values under the pointer, or in the middle; of the samples, those that are done. */
  probe() {
    const { render, canvas } = this;
    if (!render.view || render.stale || render.gl.isContextLost()) return;
    const [x, y] = this.probed ?? [canvas.width >> 1, canvas.height >> 1];
    const [split, sampled] = ["split", "sampled"].map((mode) =>
      mode === "split" || render.done ? [...render.linear(mode, [x, y])].slice(0, 3) : null,
    );
    const error = sampled && texelError(split, sampled),
      isSigned = this.shownMode() === "signed",
      counted =
        render.done && render.done < this.settings.samples ? ` (${render.done} of ${this.settings.samples})` : "";
    const line = (name, value, last, more = "") =>
      h(
        "tr",
        { "data-probe": name },
        h("th", { scope: "row" }, name, more),
        (value ?? [null, null, null]).map((v) => h("td", { "data-value": v ?? "" }, number(v, 4))),
        last,
      );
    this.probePlace.textContent = `pixel (${x}, ${y})`;
    this.probeBody.replaceChildren(
      line("split sum", split, errorCell(error, isSigned)),
      line("sampled", sampled, h("td", {}), counted),
    );
    say(this.probeBody.parentElement.querySelector("th:last-child"), errorHead(isSigned));
  }

  // --- Controls ------------------------------------------------------------------------------------------------------------

  build() {
    const { tables } = this;
    if (this.render.missing || !tables.environments.length) {
      this.view.replaceChildren(
        h("h1", {}, "Live material view"),
        h(
          "p",
          { class: "note", role: "status" },
          [this.render.missing, ...(tables.environments.length ? [] : tables.notes)].filter(Boolean).join(" "),
        ),
      );
      this.isEmpty = true;
      return;
    }
    this.counts = tables.points.map((table) => table.count);
    this.settings = this.read(current());
    const models = [...new Set(tables.lobes.map((lobe) => lobe.brdf))];
    const bar = (name, label, min, max, step, set) => {
      this.sliders[name] = slider(label, min, max, step, `live-${name}`, set);
      return this.sliders[name].element;
    };
    this.sliders = {};
    this.badge = h("p", { class: "badge" });
    this.progress = h("progress", { class: "sampling", max: 1, value: 0, "aria-label": "Samples", hidden: true });
    this.legend = h("div", { class: "error-legend", hidden: true });
    this.caption = h("p", { class: "caption" });
    this.stage = h(
      "div",
      { class: "viewer-stage live-stage" },
      this.canvas,
      this.badge,
      this.progress,
      h(
        "div",
        { class: "zoom-tools" },
        h(
          "button",
          { type: "button", title: "Farther (−)", "aria-label": "Farther", onclick: () => this.approach(1.15) },
          "−",
        ),
        h(
          "button",
          { type: "button", title: "Nearer (+)", "aria-label": "Nearer", onclick: () => this.approach(1 / 1.15) },
          "+",
        ),
        h("button", { type: "button", title: "First view (0)", onclick: () => this.turnBack() }, "Front"),
      ),
      this.caption,
    );
    this.modeChoice = choice("What is shown", MODE_CHOICES, "split", (mode) => {
      this.set({ mode });
      announce(MODE_NAMES[mode]);
    });
    this.objectChoice = choice("Object", OBJECT_CHOICES, "both", (object) => this.set({ object }));
    this.environmentPicker = select(
      "Environment",
      tables.environments.map(({ label }, i) => [i, label]),
      0,
      (i) => this.set({ environment: Number(i) }),
    );
    this.modelPicker = select(
      "Model",
      models.map((name) => [name, name]),
      models[0],
      (brdf) =>
        this.set({
          brdf,
          masking: this.maskings(brdf).includes(this.settings.masking) ? this.settings.masking : this.maskings(brdf)[0],
        }),
    );
    this.maskingBox = h("span", { class: "masking" });
    this.diffuseBox = h("input", { type: "checkbox", onchange: () => this.set({ diffuse: this.diffuseBox.checked }) });
    this.filterBox = h("input", { type: "checkbox", onchange: () => this.set({ filtered: this.filterBox.checked }) });
    this.swatch = h("i", { class: "swatch", "aria-hidden": "true" });
    this.score = h("output", {}, "–");
    this.probePlace = h("span", {});
    this.probeBody = h("tbody", {});
    const channel = (c) => (value) =>
      this.set({ albedo: this.settings.albedo.map((old, i) => (i === c ? value : old)) });
    const ownSurface = this.surfaceOfRun();
    const panel = h(
      "aside",
      { class: "panel live-panel", "aria-label": "Controls" },
      h("div", { class: "row" }, this.modeChoice),
      this.legend,
      bar("samples", "Samples a pixel", 0, this.counts.length - 1, 1, (i) => this.set({ samples: this.counts[i] })),
      bar("bias", "Level bias", -BIAS_SLIDER, BIAS_SLIDER, 0.05, (bias) => this.set({ bias })),
      h(
        "div",
        { class: "row checks" },
        h(
          "label",
          {
            title:
              "Each sample reads the level whose texels cover its solid angle (sampled); without: level 0 (sampled-unfiltered)",
          },
          this.filterBox,
          " Mip filter",
        ),
        h(
          "span",
          {
            class: "score",
            title:
              "Mean over the surface's pixels of the RGB mean of d² / (r² + 0.01), d: split sum less samples, r: samples",
          },
          "relMSE of the split sum ",
          this.score,
        ),
      ),
      h(
        "div",
        { class: "row pickers" },
        this.environmentPicker,
        this.modelPicker,
        this.maskingBox,
        h("span", { class: "choice" }, h("span", {}, "Object"), this.objectChoice),
      ),
      h(
        "fieldset",
        {},
        h("legend", {}, "Surface ", this.swatch),
        bar("red", "Albedo red", 0, 1, 0.01, channel(0)),
        bar("green", "Albedo green", 0, 1, 0.01, channel(1)),
        bar("blue", "Albedo blue", 0, 1, 0.01, channel(2)),
        bar("metallic", "Metallic", 0, 1, 0.01, (metallic) => this.set({ metallic })),
        bar("roughness", "Roughness", 0, 1, 0.005, (roughness) => this.set({ roughness })),
        bar("f0", "f0 of the dielectric", 0, 1, 0.01, (f0) => this.set({ f0 })),
        h(
          "div",
          { class: "row checks" },
          h("label", {}, this.diffuseBox, " Diffuse (SH9)"),
          ownSurface &&
            h(
              "button",
              {
                type: "button",
                title: "Surface, light and level bias of the run's cells, as far as they are one",
                onclick: () => this.set(ownSurface),
              },
              "As in the run",
            ),
          h(
            "button",
            {
              type: "button",
              onclick: () => {
                const { albedo, metallic, f0, roughness, diffuse, rotation, bias } = this.defaults();
                this.set({ albedo, metallic, f0, roughness, diffuse, rotation, bias });
              },
            },
            "Reset",
          ),
        ),
      ),
      h(
        "fieldset",
        {},
        h("legend", {}, "Light and tone"),
        bar("turn", "Environment turned", -180, 180, 1, (rotation) => this.set({ rotation })),
        bar("brightness", "Brightness", 0, 5, 0.05, (brightness) => this.set({ brightness })),
        bar("exposure", "Exposure", -12, 12, 0.1, (stops) => this.set({ stops })),
        bar("contrast", "Contrast", 0.1, 5, 0.05, (contrast) => this.set({ contrast })),
      ),
      h(
        "section",
        { class: "probe", "aria-label": "Probe" },
        h("h2", {}, "Linear values ", this.probePlace),
        scrollBox("Linear values", h("table", {}, tableHead(["", "R", "G", "B", "error"], "image"), this.probeBody)),
      ),
      h(
        "div",
        { class: "row" },
        linkButton(() => this.keepState()),
      ),
      h(
        "p",
        { class: "note keys", id: "live-keys" },
        "Drag or ",
        h("kbd", {}, "arrows"),
        " to turn · ",
        h("kbd", {}, "1"),
        "–",
        h("kbd", {}, "4"),
        " what is shown · hold ",
        h("kbd", {}, "space"),
        " for the other method · ",
        h("kbd", {}, "?"),
        " all keys",
      ),
      h(
        "p",
        { class: "note" },
        "The renderer's shaders with the run's own tables, stored as half floats. Every point sees the whole environment: no shadows, as in the renderer.",
      ),
      tables.notes.map((note) => h("p", { class: "note" }, note)),
    );
    this.view.replaceChildren(
      h("h1", { class: "visually-hidden" }, "Live material view"),
      h("div", { class: "viewer live" }, this.stage, panel),
    );
    this.listen();
    new ResizeObserver(() => {
      if (!this.stage.clientWidth || !this.render.view || !fitCanvas(this.canvas, this.stage)) return;
      this.render.restart();
      this.loop();
    }).observe(this.stage);
  }

  maskings(brdf) {
    return this.tables.lobes.filter((lobe) => lobe.brdf === brdf).map((lobe) => lobe.masking);
  }

  /** Surface settings that all cells of the run share, null when there are none. */
  surfaceOfRun() {
    const only = (name) => {
      const values = [...new Set(rows.map((row) => row.axes[name]).filter(Boolean))];
      return values.length === 1 ? values[0] : null;
    };
    const own = {},
      colour = (text) => {
        const parts = text.split(",").map(Number);
        return parts.length === 3 ? parts : [parts[0], parts[0], parts[0]];
      };
    if (only("albedo") !== null) own.albedo = colour(only("albedo"));
    if (only("metallic") !== null) own.metallic = Number(only("metallic"));
    // One slider stands for all three channels.
    if (only("f0") !== null) own.f0 = colour(only("f0"))[0];
    if (only("alpha") !== null) own.roughness = Math.sqrt(Number(only("alpha")));
    if (only("diffuse") !== null) own.diffuse = only("diffuse") !== "none";
    if (only("environment_rotation_deg") !== null) own.rotation = Number(only("environment_rotation_deg"));
    if (only("environment_scale") !== null) own.brightness = Number(only("environment_scale"));
    if (only("lod_bias") !== null) own.bias = Number(only("lod_bias"));
    return Object.keys(own).length ? own : null;
  }

  syncControls() {
    const { settings: s, sliders } = this;
    const put = (name, value, text) => {
      sliders[name].input.value = value;
      sliders[name].output.textContent = text;
      sliders[name].input.setAttribute("aria-valuetext", text);
    };
    s.albedo.forEach((value, c) => put(["red", "green", "blue"][c], value, number(round(value, 3))));
    put("metallic", s.metallic, number(round(s.metallic, 3)));
    const alpha = s.roughness ** 2,
      floor = this.tables.alpha_min;
    put(
      "roughness",
      s.roughness,
      `${number(round(s.roughness, 3))} · α ${alpha <= floor ? `${number(floor)} (a mirror)` : number(alpha)}`,
    );
    put("f0", s.f0, number(round(s.f0, 3)));
    put("turn", s.rotation, `${number(round(s.rotation, 2))}°`);
    put("bias", s.bias, s.filtered ? `${s.bias > 0 ? "+" : ""}${number(round(s.bias, 3))}` : "without filter: none");
    sliders.bias.input.disabled = !s.filtered;
    put("brightness", s.brightness, `× ${number(round(s.brightness, 3))}`);
    put("exposure", s.stops, stopsText(s.stops));
    put("contrast", s.contrast, number(round(s.contrast, 3)));
    put("samples", this.counts.indexOf(s.samples), String(s.samples));
    this.swatch.style.background = `rgb(${s.albedo.map((x) => Math.round(255 * x ** (1 / 2.2)))})`;
    this.modeChoice.press(s.mode);
    this.objectChoice.press(s.object);
    this.environmentPicker.querySelector("select").value = s.environment;
    this.modelPicker.querySelector("select").value = s.brdf;
    const maskings = this.maskings(s.brdf);
    this.maskingBox.replaceChildren(
      ...(maskings.length > 1
        ? [
            select(
              "Masking",
              maskings.map((name) => [name, name]),
              s.masking,
              (masking) => this.set({ masking }),
            ),
          ]
        : []),
    );
    this.diffuseBox.checked = s.diffuse;
    this.filterBox.checked = s.filtered;
    const isError = ["error", "signed"].includes(s.mode);
    this.legend.hidden = !isError;
    if (isError && this.legend.dataset.mode !== s.mode) fillErrorLegend(this.legend, s.mode === "signed");
    this.legend.dataset.mode = s.mode;
    const light = this.tables.environments[s.environment],
      [width, height] = light.levels[0].size;
    this.caption.textContent = light.first_level
      ? `environment shown at ${width} × ${height} of ${light.size[0]} × ${light.size[1]}`
      : "";
  }

  // --- Pointer and keys ----------------------------------------------------------------------------------------------------

  approach(factor) {
    this.set({ distance: clamp(this.settings.distance * factor, ...DISTANCE) });
  }

  turnBack() {
    const { yaw, pitch, distance } = this.defaults();
    this.set({ yaw, pitch, distance });
  }

  listen() {
    const { canvas } = this,
      pointers = new Map();
    let spread = 0;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
      spread = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) {
        const box = canvas.getBoundingClientRect();
        this.probed = [
          ["clientX", box.left, box.width, canvas.width],
          ["clientY", box.top, box.height, canvas.height],
        ].map(([name, start, css, side]) => clamp(Math.floor(((event[name] - start) / css) * side), 0, side - 1));
        this.probing ||= requestAnimationFrame(() => {
          this.probing = 0;
          this.probe();
        });
        return;
      }
      pointers.set(event.pointerId, event);
      if (pointers.size === 2) {
        const [a, b] = [...pointers.values()],
          distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (spread) this.approach(spread / Math.max(1, distance));
        spread = distance;
        return;
      }
      // Half a turn over the width of the stage.
      const degrees = 180 / this.stage.clientWidth;
      this.turn((before.clientX - event.clientX) * degrees, (event.clientY - before.clientY) * degrees);
    });
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.approach(event.deltaY < 0 ? 1 / 1.08 : 1.08);
      },
      { passive: false },
    );
  }

  /** Handles a key; true when it was one of the view's. */
  key(event) {
    if (this.isEmpty) return false;
    const actions = {
      " ": () => this.hold(true),
      ArrowLeft: () => this.turn(-5, 0),
      ArrowRight: () => this.turn(5, 0),
      ArrowUp: () => this.turn(0, 5),
      ArrowDown: () => this.turn(0, -5),
      "+": () => this.approach(1 / 1.15),
      "=": () => this.approach(1 / 1.15),
      "-": () => this.approach(1.15),
      0: () => this.turnBack(),
      "[": () => this.set({ stops: clamp(this.settings.stops - 0.5, -12, 12) }),
      "]": () => this.set({ stops: clamp(this.settings.stops + 0.5, -12, 12) }),
    };
    MODES.forEach((mode, i) => {
      actions[i + 1] = () => {
        this.set({ mode });
        announce(MODE_NAMES[mode]);
      };
    });
    // Space belongs to a button or a box that has the focus.
    if (!(event.key in actions) || (event.key === " " && event.target.matches("button, input, a, summary")))
      return false;
    if (!(event.key === " " && event.repeat)) actions[event.key]();
    return true;
  }

  /** Shows the other method while a key is down. */
  hold(isHeld) {
    if (this.isEmpty || this.held === isHeld) return;
    this.held = isHeld;
    this.set({});
  }
}

let live = null;
export function showLive(view, state) {
  live ??= new Live(view);
  return live.isEmpty ? undefined : live.show(state);
}
export const liveKey = (event) => live?.key(event) ?? false;
export const liveRelease = () => live?.hold(false);
/** The view itself, for tests: its renderer reads linear values back. */
export const liveView = () => live;
