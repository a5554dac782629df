// The live view: the run's model in the run's light, shaded by the renderer's shaders, and its error against a reference.

import { axisOf, lightTables, texelError } from "report/data";
import { announce, byId, choice, h, number, say, select, stopsText } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { LiveRender } from "report/live-render";
import { keepContext } from "report/program";
import { Probe, build, clamp, fitCanvas, followPointers, linkButton, real, sliderText, stageTools } from "report/stage";
import { keep, state as current } from "report/state";

const METHODS = [
  ["split", "Split sum", "one lookup each in the prefiltered map and the DFG table (1)"],
  ["sampled", "Sampled", "filtered importance sampling at every pixel (2)"],
  ["reference", "Reference", "the same with up to 4096 samples (3)"],
];
const MODES = [
  ["image", "Image", "the image through the tone curve"],
  ["error", "Error", "relative error against the reference (E)"],
  ["signed", "Signed", "signed relative error against the reference (S)"],
];
const NAMES = { split: "split sum", sampled: "sampled", reference: "reference" };
const COUNTS = [1, 4, 16, 64, 256, 1024];
/** After this long without a change, ms, the view is at rest: samples are added, and its address is kept. */
const REST_MS = 180;
const EV = [-12, 12];
const PITCH_MAX = 88;

const PANEL = `<aside class="panel live-panel" aria-label="Controls">
  <div class="row" data-ref="modes"></div><div class="error-legend" data-ref="legend" hidden></div>
  <p class="told" data-ref="score"></p>
  ${sliderText("Samples a pixel", "live-n", 0, 0, 1)}
  <div class="row pickers" data-ref="pickers"></div>
  <fieldset><legend>Surface</legend>
    ${sliderText("Roughness", "live-roughness", 0, 1, 0.005)}
    ${sliderText("Metallic", "live-metallic", 0, 1, 0.01)}
    ${sliderText("f0 of a dielectric", "live-f0", 0, 1, 0.01)}
    <div class="row checks"><label><input type="color" id="live-albedo"> Albedo</label>
      <label><input type="checkbox" id="live-diffuse"> Diffuse (SH9)</label>
      <button type="button" data-ref="own" title="The surface of the run">As in the run</button></div></fieldset>
  <fieldset><legend>Light and tone</legend>
    ${sliderText("Environment turned", "live-turn", -180, 180, 1)}
    ${sliderText("Exposure", "live-ev", EV[0], EV[1], 0.1)}</fieldset>
  <div data-ref="rest"></div>
  <p class="note keys" id="live-keys">Drag or <kbd>arrows</kbd> to turn · <kbd>1</kbd>–<kbd>3</kbd> split sum, sampled,
    reference · <kbd>E</kbd> error · <kbd>S</kbd> signed · hold <kbd>space</kbd> for the reference</p>
  <p class="note">The reference is importance sampling at the finest level that the page holds, each sample filtered to
    the solid angle that it stands for. Samples are added, up to 4096, until half of them agree with all within a
    hundredth of the split sum's error. No shadows, as in the renderer.</p></aside>`;

/** Linear reflectance and its code in a colour field. */
const toCode = (x) => Math.round(255 * x ** (1 / 2.2));
const fromCode = (code) => (code / 255) ** 2.2;
const hex = (color) => `#${color.map((x) => toCode(x).toString(16).padStart(2, "0")).join("")}`;

/** The middle of the values that the run gives an axis; null when it leaves it alone. */
function middle(name) {
  const values = (axisOf[name]?.values ?? []).filter(Boolean);
  return values.length ? values[values.length >> 1].split(",").map(Number) : null;
}

class Live {
  constructor(view) {
    this.view = view;
    this.tables = lightTables();
    this.canvas = h("canvas", { tabindex: 0, role: "img", "aria-label": "Live", "aria-describedby": "live-keys" });
    this.render = new LiveRender(this.canvas);
    this.isHeld = false;
    this.changed = -Infinity;
    const { environments, notes } = this.tables;
    this.isEmpty = Boolean(this.render.missing || !environments.length);
    if (this.isEmpty) {
      const why = [this.render.missing, ...(environments.length ? [] : notes)].filter(Boolean).join(" ");
      view.replaceChildren(h("h1", {}, "Live"), h("p", { class: "note", role: "status" }, why));
      return;
    }
    this.start = this.defaults();
    this.build();
    keepContext(this.canvas, () => {
      this.render.reset();
      this.apply();
    });
  }

  // --- State -----------------------------------------------------------------------------------------------------

  /** Every setting under its name in the address. What is null is as in the model. */
  defaults() {
    const [roughness, alpha, albedo, turn] = [
      "perceptual_roughness",
      "alpha",
      "albedo",
      "environment_rotation_deg",
    ].map(middle);
    return {
      ...{ model: 0, env: 0, lobe: 0, method: "split", mode: "image", n: this.counts[this.counts.length >> 1] },
      roughness: roughness?.[0] ?? (alpha && Math.sqrt(alpha[0])),
      albedo: albedo && [0, 1, 2].map((c) => albedo[c] ?? albedo[0]),
      metallic: middle("metallic")?.[0] ?? null,
      f0: middle("f0")?.[0] ?? null,
      diffuse: axisOf.diffuse?.values.some((value) => value && value !== "none") ?? false,
      ...{ turn: turn?.[0] ?? 0, ev: 0, yaw: 0, pitch: 0, distance: 1 },
    };
  }

  /** The sample counts of the run and some more. */
  get counts() {
    const own = (axisOf.samples?.values ?? []).map(Number).filter((count) => count >= 1 && count <= 4096);
    return [...new Set([...own, ...COUNTS])].sort((a, b) => a - b);
  }

  /** The settings that the address asks for; what it does not name, or names wrongly, is the default. */
  read(state) {
    const { start, tables } = this;
    const index = (list) => (text) => Math.trunc(real(text, [0, list.length - 1]));
    const one = (values) => (text) => (values.some(([name]) => name === text) ? text : null);
    const within = (lo, hi) => (text) => real(text, [lo, hi]);
    const [share, turn] = [within(0, 1), within(-360, 360)];
    const color = (text) => (text.split(",").length === 3 ? text.split(",").map((x) => share(x) ?? 0) : null);
    const parsers = {
      ...{ model: index(tables.models), env: index(tables.environments), lobe: index(tables.lobes) },
      ...{ method: one(METHODS), mode: one(MODES) },
      n: (text) => this.counts.find((count) => count >= Number(text)) ?? null,
      ...{ roughness: share, albedo: color, metallic: share, f0: share, diffuse: (text) => text === "true" },
      ...{ turn, ev: within(...EV), yaw: turn, pitch: turn, distance: within(0.1, 4) },
    };
    const read = ([name, parse]) => [name, (state[name] && parse(state[name])) ?? start[name]];
    return Object.fromEntries(Object.entries(parsers).map(read));
  }

  keepState() {
    this.isUnkept = false;
    if (current().view !== "live") return;
    const text = (x) => (Array.isArray(x) ? x.map(text).join(",") : typeof x === "number" ? Number(x.toFixed(4)) : x);
    const given = ([name, value]) => [name, String(text(value)) === String(text(this.start[name])) ? "" : text(value)];
    keep(Object.fromEntries(Object.entries(this.settings).map(given)));
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
    const [bias, brightness] = [middle("lod_bias")?.[0] ?? 0, middle("environment_scale")?.[0] ?? 1];
    if (await this.render.show({ ...this.settings, ...this.shown, bias, brightness })) this.loop();
  }

  /** Changes settings; some leave the shading alone. */
  set(details) {
    Object.assign(this.settings, details);
    this.isUnkept = true;
    if (!Object.keys(details).every((name) => ["method", "mode", "ev"].includes(name))) return this.apply();
    this.changed = performance.now();
    this.syncControls();
    this.render.display({ ...details, ...this.shown });
    this.loop();
    return undefined;
  }

  /** What is seen: while space is held the reference, which has no error. */
  get shown() {
    const method = this.isHeld ? "reference" : this.settings.method;
    return { method, mode: method === "reference" ? "image" : this.settings.mode };
  }

  turn(yaw, pitch) {
    const { settings } = this;
    const raised = (this.tables.models[settings.model].camera.pitch * 180) / Math.PI;
    const wanted = clamp(settings.pitch + pitch, -PITCH_MAX - raised, PITCH_MAX - raised);
    this.set({ yaw: ((((settings.yaw + yaw + 180) % 360) + 360) % 360) - 180, pitch: wanted });
  }

  approach(factor) {
    this.set({ distance: clamp(this.settings.distance / factor, 0.1, 4) });
  }

  // --- Drawing ---------------------------------------------------------------------------------------------------

  loop() {
    this.canvas.dataset.ready = "";
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      if (byId("view-live").hidden || !this.render.view || this.render.gl.isContextLost()) return;
      const isAtRest = performance.now() - this.changed > REST_MS;
      const isDrawn = this.render.step(!isAtRest);
      const isDone = isDrawn && isAtRest && this.render.isComplete;
      if (isAtRest && this.isUnkept) this.keepState();
      if (isDone) this.canvas.dataset.ready = "1";
      if (isDrawn) this.describe();
      if (!isDone) this.loop();
    });
  }

  describe() {
    const { render, settings } = this;
    const { method, mode } = this.shown;
    const { errors, done, view } = render;
    const counted = (way) => (done[way] < render.total(way) ? `${done[way]} of ${render.total(way)}` : `${done[way]}`);
    const image = method === "split" ? "split sum" : `${method}, ${counted(method)} samples a pixel`;
    const what = mode === "image" ? image : `${mode === "signed" ? "signed error" : "error"} of ${image}`;
    say(this.badge, what);
    const error = errors?.[method] ?? null;
    const own = errors && `${number(errors.half, 2)} is its own: half of its samples against all`;
    const until = render.isJudged ? "" : ", more to come";
    const score = error === null ? "relMSE …" : `relMSE of ${NAMES[method]} ${number(error)}`;
    say(this.score, `${score}. Reference: ${done.reference} samples a pixel${until}${own ? `; ${own}` : ""}.`);
    Object.assign(this.canvas.dataset, { method, mode, relmse: errors?.split ?? "", noise: errors?.half ?? "" });
    this.probe();
    if (render.isComplete) {
      const places = `${view.shape.label} in ${view.light.label}, ${view.lobe.brdf}`;
      const surface = settings.roughness === null ? "own materials" : `roughness ${number(settings.roughness)}`;
      this.canvas.setAttribute("aria-label", `${places}, ${surface}; ${what}; ${score}`);
    }
  }

  /** The linear values under the pointer, or in the middle; of the samples, those that are done. */
  probe() {
    const { render, canvas } = this;
    if (!render.view || render.isStale || render.gl.isContextLost()) return;
    const [x, y] = this.probed ?? [canvas.width >> 1, canvas.height >> 1];
    const at = (way) => (render.done[way] ? [...render.linear(way, [x, y])].slice(0, 3) : null);
    const truth = at("reference");
    const line = (key) => {
      const value = key === "reference" ? truth : at(key);
      const error = key === "reference" || !value || !truth ? null : texelError(value, truth);
      const count = key === "split" ? "" : ` ${render.done[key]}`;
      return { key, name: NAMES[key] + count, value, error, isCurrent: key === this.shown.method };
    };
    const keys = ["split", "sampled", "reference"].filter((key) => key !== "sampled" || this.shown.method === key);
    this.probeTable.show(`pixel (${x}, ${y})`, this.shown.mode === "signed", keys.map(line)); // prettier-ignore
  }

  // --- Controls --------------------------------------------------------------------------------------------------

  build() {
    const { tables } = this;
    const panel = build(PANEL);
    this.panel = panel.root;
    this.legend = panel.legend;
    this.score = panel.score;
    this.methodChoice = choice("Method", METHODS, "split", (method) => this.set({ method }));
    this.modeChoice = choice("What is shown", MODES, "image", (mode) => this.set({ mode }));
    panel.modes.append(this.methodChoice, this.modeChoice);
    const pick = (name, label, labels) =>
      select(label, labels.map((text, i) => [i, text]), 0, (i) => this.set({ [name]: Number(i) })); // prettier-ignore
    const lobes = tables.lobes.map(({ brdf, masking }) => `${brdf}, ${masking} masking`);
    this.pickers = {
      model: pick("model", "Model", tables.models.map(({ label }) => label)), // prettier-ignore
      env: pick("env", "Environment", tables.environments.map(({ label }) => label)), // prettier-ignore
      lobe: pick("lobe", "BRDF", lobes),
    };
    panel.pickers.append(...Object.values(this.pickers));
    this.inputs = Object.fromEntries(
      [...this.panel.querySelectorAll("input")].map((input) => [input.id.slice(5), input]),
    );
    this.inputs.n.max = String(this.counts.length - 1);
    const written = {
      n: (input) => this.counts[Number(input.value)],
      diffuse: (input) => input.checked,
      albedo: (input) => input.value.match(/[0-9a-f]{2}/g).map((code) => fromCode(parseInt(code, 16))),
    };
    for (const [name, input] of Object.entries(this.inputs)) {
      input.addEventListener("input", () => this.set({ [name]: written[name]?.(input) ?? Number(input.value) }));
    }
    panel.own.addEventListener("click", () => {
      const { albedo, metallic, f0, roughness, diffuse, turn } = this.start;
      this.set({ albedo, metallic, f0, roughness, diffuse, turn });
    });
    this.probeTable = new Probe();
    const notes = tables.notes.map((note) => h("p", { class: "note" }, note));
    panel.rest.append(
      this.probeTable.element,
      linkButton(() => this.keepState()),
      ...notes,
    );
    this.badge = h("p", { class: "badge" });
    this.caption = h("p", { class: "caption" });
    const tools = [
      ["−", "Farther (−)", () => this.approach(1 / 1.15)],
      ["+", "Nearer (+)", () => this.approach(1.15)],
      ["⟲", "As the run sees it (0)", () => this.set({ yaw: 0, pitch: 0, distance: 1 })],
    ];
    this.stage = h(
      "div",
      { class: "viewer-stage live-stage" },
      this.canvas,
      this.badge,
      stageTools(tools),
      this.caption,
    );
    const body = h("div", { class: "viewer live" }, this.stage, this.panel);
    this.view.replaceChildren(h("h1", { class: "visually-hidden" }, "Live"), body);
    this.listen();
  }

  listen() {
    followPointers(this.canvas, {
      // Half a turn over the width of the stage.
      drag: (dx, dy) => this.turn((-dx * 180) / this.canvas.width, (dy * 180) / this.canvas.width),
      zoom: (factor) => this.approach(factor),
      hover: (place) => {
        this.probed = place.map((at, i) => clamp(Math.floor(at), 0, [this.canvas.width, this.canvas.height][i] - 1));
        this.probing ||= requestAnimationFrame(() => {
          this.probing = 0;
          this.probe();
        });
      },
    });
    new ResizeObserver(() => {
      if (!this.stage.clientWidth || !this.render.view || !fitCanvas(this.canvas, this.stage)) return;
      this.render.restart();
      this.loop();
    }).observe(this.stage);
  }

  syncControls() {
    const { settings, inputs, tables } = this;
    const light = tables.environments[settings.env];
    const model = tables.models[settings.model];
    const own = (model.spheres[0] ?? model.parts[0]).surface;
    const value = (name, otherwise) => settings[name] ?? otherwise;
    const roughness = value("roughness", Math.sqrt(own.alpha));
    const isOwn = (name) => (settings[name] === null ? " (own)" : "");
    const put = (name, at, text) => {
      inputs[name].value = String(at);
      inputs[name].previousElementSibling?.querySelector("output")?.replaceChildren(text);
      inputs[name].setAttribute("aria-valuetext", text);
    };
    put("n", this.counts.indexOf(settings.n), String(settings.n));
    const alpha = Math.max(roughness ** 2, tables.alpha_min);
    put("roughness", roughness, `${number(roughness)} · α ${number(alpha)}${isOwn("roughness")}`);
    put("metallic", value("metallic", own.metallic), number(value("metallic", own.metallic)) + isOwn("metallic"));
    put("f0", value("f0", own.f0[0]), number(value("f0", own.f0[0])) + isOwn("f0"));
    put("albedo", hex(value("albedo", own.albedo)), "");
    put("turn", settings.turn, `${number(settings.turn)}°`);
    put("ev", settings.ev, stopsText(settings.ev));
    inputs.diffuse.checked = settings.diffuse;
    for (const [name, picker] of Object.entries(this.pickers)) {
      picker.querySelector("select").value = String(settings[name]);
      picker.hidden = picker.querySelectorAll("option").length < 2;
    }
    const { method, mode } = this.shown;
    inputs.n.closest("label").hidden = method !== "sampled";
    this.methodChoice.press(method);
    this.modeChoice.press(mode);
    this.legend.hidden = mode === "image";
    if (mode !== "image") fillErrorLegend(this.legend, mode === "signed", false);
    const [width, height] = light.levels[0].size;
    const isCoarse = `environment at ${width} × ${height} of ${light.size[0]} × ${light.size[1]}`;
    say(this.caption, light.first_level ? isCoarse : "");
  }

  /** Handles a key; true when it was one of the view's. */
  key(event) {
    if (this.isEmpty) return false;
    const { ev, mode } = this.settings;
    const show = (wanted) => this.set({ mode: mode === wanted ? "image" : wanted });
    const actions = {
      " ": () => this.hold(true),
      ArrowLeft: () => this.turn(-5, 0),
      ArrowRight: () => this.turn(5, 0),
      ArrowUp: () => this.turn(0, 5),
      ArrowDown: () => this.turn(0, -5),
      "+": () => this.approach(1.15),
      "-": () => this.approach(1 / 1.15),
      0: () => this.set({ yaw: 0, pitch: 0, distance: 1 }),
      "[": () => this.set({ ev: clamp(ev - 0.5, ...EV) }),
      "]": () => this.set({ ev: clamp(ev + 0.5, ...EV) }),
      e: () => show("error"),
      s: () => show("signed"),
    };
    METHODS.forEach(([method], i) => (actions[i + 1] = () => this.set({ method })));
    const name = event.key.length === 1 ? event.key.toLowerCase().replace("=", "+") : event.key;
    // Space belongs to a button or a box that has the focus.
    if (!(name in actions) || (name === " " && event.target.matches("button, input, a, summary"))) return false;
    if (name !== " " || !event.repeat) actions[name]();
    if (/[1-3es]/.test(name)) announce(`${NAMES[this.shown.method]}, ${this.shown.mode}`);
    return true;
  }

  /** Shows the reference while a key is down. */
  hold(isHeld) {
    if (this.isEmpty || this.isHeld === isHeld) return;
    this.isHeld = isHeld;
    this.set({ mode: this.settings.mode });
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
