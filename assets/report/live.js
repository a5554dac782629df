// The live view: the run's model in its light, shaded by the renderer's shaders, and its error against a reference.

import { axisOf, firstRow, lightTables, scenes, short, texelError } from "report/data";
import { announce, byId, h, number, say, stopsText } from "report/dom";
import { fillErrorLegend } from "report/legend";
import { LiveRender } from "report/live-render";
import { keepContext } from "report/program";
import { Controls, MODES, build, clamp, fitCanvas, followHandle, followPointers, real } from "report/stage";
import { showProbe, showSides } from "report/stage";
import { keep, state as current } from "report/state";

const COUNTS = [1, 4, 16, 64, 256, 1024];
/** After this long without a change, ms, the view is at rest: samples are added, and its address is kept. */
const REST_MS = 180;
const DISTANCE = [0.1, 4];
const PITCH_MAX = 88;
const FRONT = { yaw: 0, pitch: 0, distance: 1 };
/** Settings of surfaces and their axes. */
const SURFACE = {
  ...{
    roughness: "alpha",
    coat_roughness: "coat_alpha",
    sheen_roughness: "sheen_alpha",
    metallic: "metallic",
    f0: "f0",
  },
  ...{ albedo: "albedo", anisotropy: "anisotropy", anisotropy_turn: "anisotropy_rotation_deg", coat: "coat" },
  sheen: "sheen_color",
};
const COLORS = ["albedo", "sheen"];
/** Sliders of the albedo's channels. */
const CHANNELS = ["albedo_r", "albedo_g", "albedo_b"];
/** Settings that act after shading. */
const DISPLAYED = ["method", "against", "mode", "ev", "contrast", "split"];

/** Linear reflectance and its code in a colour field. */
const toCode = (x) => Math.round(255 * x ** (1 / 2.2));
const fromCode = (code) => (code / 255) ** 2.2;
const hex = (color) => `#${color.map((x) => toCode(x).toString(16).padStart(2, "0")).join("")}`;

/** The numbers of an axis in the case with the largest visible error, else its middle ones; null if it is not set. */
function worst(name) {
  const values = (axisOf[name]?.values ?? []).filter(Boolean);
  const text = (scenes.length && firstRow(() => true)?.axes[name]) || values[values.length >> 1];
  return text ? text.split(",").map(Number) : null;
}

class Live {
  constructor(view) {
    this.tables = lightTables();
    this.parts = build(view, "live-stage");
    this.canvas = this.parts.canvas;
    this.render = new LiveRender(this.canvas);
    this.isHeld = false;
    this.changed = -Infinity;
    const { environments, notes, models, lobes, orientations } = this.tables;
    this.isEmpty = Boolean(this.render.missing || !environments.length);
    if (this.isEmpty) {
      const why = [this.render.missing, ...(environments.length ? [] : notes)].filter(Boolean).join(" ");
      view.replaceChildren(h("h1", {}, "Live"), h("p", { class: "note", role: "status" }, why));
      return;
    }
    const own = (axisOf.samples?.values ?? []).map(Number).filter((count) => count >= 1 && count <= 4096);
    /** The sample counts of the run and some more. */
    this.counts = [...new Set([...own, ...COUNTS])].sort((a, b) => a - b);
    this.ways = [...this.tables.methods.map(({ name }) => name), "reference"];
    this.bends = Object.keys(this.tables.bends);
    this.start = this.defaults();
    this.controls = new Controls(view, (name, value) => this.set(this.changes(name, value)));
    this.controls.named.n.max = this.counts.length - 1;
    this.controls.fill("model", models.map(({ label }) => label)); // prettier-ignore
    this.controls.fill("orientation", orientations.map(({ k }) => String(k))); // prettier-ignore
    this.controls.fill("env", environments.map(({ label }) => label)); // prettier-ignore
    this.controls.fill("lobe", lobes.map(({ brdf, masking }) => `${brdf}, ${masking} masking`)); // prettier-ignore
    const titles = this.ways.map((way) => this.titleOf(way));
    this.controls.fill("bend", this.bends, this.bends);
    for (const name of ["method", "against"]) this.controls.fill(name, titles, this.ways);
    this.parts.notes.append(...notes.map((note) => h("p", { class: "note" }, note)));
    this.listen();
    keepContext(this.canvas, () => {
      this.render.reset();
      this.apply();
    });
  }

  titleOf(way) {
    return this.tables.methods.find(({ name }) => name === way)?.title ?? "Reference";
  }

  /** Every setting under its name in the address: the case with the largest visible error. Null takes the model's value. */
  defaults() {
    const { models, environments, lobes } = this.tables;
    const { axes = {} } = firstRow(() => true) ?? {};
    const own = ([name, axis]) => {
      const given = worst(axis);
      const roughness = worst(axis.replace("alpha", "perceptual_roughness"))?.[0];
      if (axis.endsWith("alpha")) return [name, roughness ?? (given && Math.sqrt(given[0]))];
      return [name, COLORS.includes(name) ? given && [0, 1, 2].map((c) => given[c] ?? given[0]) : (given?.[0] ?? null)];
    };
    const place = (all, axis) =>
      Math.max(0, all.map(({ label, brdf }) => label ?? brdf).indexOf(short(axis, axes[axis]))); // prettier-ignore
    return {
      ...{ model: place(models, "scene"), env: place(environments, "environment"), lobe: place(lobes, "brdf") },
      method: this.ways.includes(axes.method) ? axes.method : this.ways[0],
      ...{ orientation: 0, against: "reference", mode: "image", split: 0.5 },
      n: this.counts[this.counts.length >> 1],
      ...Object.fromEntries(Object.entries(SURFACE).map(own)),
      bend: axes.bend || "none",
      diffuse: axisOf.diffuse?.values.some((value) => value && value !== "none") ?? false,
      ...{ turn: worst("environment_rotation_deg")?.[0] ?? 0, brightness: worst("environment_scale")?.[0] ?? 1 },
      ...{ ev: 0, contrast: worst("contrast")?.[0] ?? 1, ...FRONT },
    };
  }

  /** The settings in the address; missing and invalid ones are the default. */
  read(state) {
    const { start, tables } = this;
    const index = (list) => (text) => Math.trunc(real(text, [0, list.length - 1]));
    const one = (values) => (text) => (values.includes(text) ? text : null);
    const within = (lo, hi) => (text) => real(text, [lo, hi]);
    const [share, turn] = [within(0, 1), within(-360, 360)];
    const parser = (name) => [name, COLORS.includes(name) ? color : within(...this.controls.range(name))];
    const color = (text) => (text.split(",").length === 3 ? text.split(",").map((x) => share(x) ?? 0) : null);
    const parsers = {
      ...{ model: index(tables.models), env: index(tables.environments), lobe: index(tables.lobes) },
      orientation: index(tables.orientations),
      ...{ method: one(this.ways), against: one(this.ways), mode: one(MODES) },
      split: within(-1, 1),
      n: (text) => this.counts.find((count) => count >= Number(text)) ?? null,
      ...Object.fromEntries(Object.keys(SURFACE).map(parser)),
      ...{ bend: one(this.bends), diffuse: (text) => text === "true", turn },
      ...Object.fromEntries(["brightness", "ev", "contrast"].map(parser)),
      ...{ yaw: turn, pitch: turn, distance: within(...DISTANCE) },
    };
    const read = ([name, parse]) => [name, (state[name] && parse(state[name])) ?? start[name]];
    return Object.fromEntries(Object.entries(parsers).map(read));
  }

  /** The settings that a control changes. */
  changes(name, value) {
    const channel = CHANNELS.indexOf(name);
    if (channel < 0) return { [name]: this.written(name, value) };
    const albedo = [...(this.settings.albedo ?? this.surface.albedo)];
    albedo[channel] = value;
    return { albedo };
  }

  /** The model's own values, as its first surface has them. */
  get surface() {
    const model = this.tables.models[this.settings.model];
    return (model.spheres[0] ?? model.parts[0]).surface;
  }

  /** A setting as its control writes it. */
  written(name, value) {
    if (name === "n") return this.counts[value];
    if (COLORS.includes(name)) return value.match(/[0-9a-f]{2}/g).map((code) => fromCode(parseInt(code, 16)));
    return ["model", "env", "lobe", "orientation"].includes(name) ? Number(value) : value;
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

  /** Redraws after a change of shading. */
  async apply() {
    this.changed = performance.now();
    this.syncControls();
    fitCanvas(this.canvas, this.parts.stage);
    const bias = worst("lod_bias")?.[0] ?? 0;
    if (await this.render.show({ ...this.settings, ...this.shown, bias })) this.loop();
  }

  /** Changes settings; some leave the shading alone. */
  set(details) {
    Object.assign(this.settings, details);
    this.isUnkept = true;
    if (!Object.keys(details).every((name) => DISPLAYED.includes(name))) return this.apply();
    this.changed = performance.now();
    this.syncControls();
    this.render.display({ ...details, ...this.shown });
    this.loop();
    return undefined;
  }

  /** The visible image: the method, or its reference (without an error) while space is held. */
  get shown() {
    const { method, against, mode, split } = this.settings;
    const seen = this.isHeld ? against : method;
    const shown = seen === against ? "image" : mode;
    return { seen, mode: shown, wipe: shown === "image" && split >= 0 && seen !== against ? split : null };
  }

  turn(yaw, pitch) {
    const { settings } = this;
    const raised = (this.tables.models[settings.model].camera.pitch * 180) / Math.PI;
    const wanted = clamp(settings.pitch + pitch, -PITCH_MAX - raised, PITCH_MAX - raised);
    this.set({ yaw: ((((settings.yaw + yaw + 180) % 360) + 360) % 360) - 180, pitch: wanted });
  }

  approach(factor) {
    this.set({ distance: clamp(this.settings.distance / factor, DISTANCE[0], DISTANCE[1]) });
  }

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
    const { method, against } = settings;
    const { seen, mode, wipe } = this.shown;
    const { errors, done, view, isJudged } = render;
    const isWhole = (way) => done[way] === render.total(way) || (way === "reference" && isJudged);
    const counted = (way) => `, ${done[way]}${isWhole(way) ? "" : ` of ${render.total(way)}`} samples a pixel`;
    const labelled = (way) => this.titleOf(way) + (render.total(way) > 1 ? counted(way) : "");
    const error = `${mode === "signed" ? "signed error" : "error"} of ${labelled(method)} against ${labelled(against)}`;
    const what = mode === "image" ? labelled(seen) : error;
    showSides(this.parts, what, labelled(against), render.isStarted(against) ? wipe : null);
    const value = errors && (isJudged ? "" : "so far about ") + number(errors.own, isJudged ? 3 : 1);
    const score = `relMSE of ${this.titleOf(method)} against ${labelled(against)}: ${value ?? "not yet known"}`;
    const noise = errors?.noise ? `; noise of the reference itself: ${number(errors.noise, 2)}` : "";
    say(this.parts.score, `${score}${noise}.`);
    Object.assign(this.canvas.dataset, { method: seen, mode, relmse: errors?.own ?? "", noise: errors?.noise ?? "" });
    this.probe();
    if (render.isComplete) {
      const places = `${view.shape.label} in ${view.light.label}, ${view.lobe.brdf}`;
      const surface = settings.roughness === null ? "own materials" : `roughness ${number(settings.roughness)}`;
      this.canvas.setAttribute("aria-label", `${places}, ${surface}; ${what}; ${score}`);
    }
  }

  /** The linear values under the pointer, or in the middle, from the samples so far. */
  probe() {
    const { render, canvas } = this;
    if (!render.view || render.isStale || render.gl.isContextLost()) return;
    const [x, y] = this.probed ?? [canvas.width >> 1, canvas.height >> 1];
    const at = (way) => (render.done[way] ? [...render.linear(way, [x, y])].slice(0, 3) : null);
    const { method, against } = this.settings;
    const truth = at(against);
    const line = (key) => {
      const value = key === against ? truth : at(key);
      const error = key === against || !value || !truth ? null : texelError(value, truth, render.lightMean);
      const count = render.total(key) === 1 ? "" : ` ${render.done[key]}`;
      return { key, name: this.titleOf(key) + count, value, error, isCurrent: key === this.shown.seen };
    };
    const lines = [...new Set([method, against])].map(line);
    showProbe(this.parts, `pixel (${x}, ${y})`, this.shown.mode === "signed", lines);
  }

  listen() {
    const { stage, out, in: nearer, front, own, handle } = this.parts;
    followHandle(handle, stage, (split) => this.set({ split }));
    out.addEventListener("click", () => this.approach(1 / 1.15));
    nearer.addEventListener("click", () => this.approach(1.15));
    front.addEventListener("click", () => this.set(FRONT));
    const names = [...Object.keys(SURFACE), "diffuse", "orientation", "turn", "brightness"];
    own.addEventListener("click", () => this.set(Object.fromEntries(names.map((name) => [name, this.start[name]]))));
    followPointers(this.canvas, {
      // Half a turn over the width of the stage.
      drag: (dx, dy) => this.turn((-dx * 180) / this.canvas.width, (dy * 180) / this.canvas.width),
      zoom: (factor) => this.approach(factor),
      hover: (place) => {
        this.probed = place.map((at, i) => clamp(Math.floor(at), 0, [this.canvas.width, this.canvas.height][i] - 1));
        cancelAnimationFrame(this.probing);
        this.probing = requestAnimationFrame(() => this.probe());
      },
    });
    new ResizeObserver(() => {
      if (!stage.clientWidth || !this.render.view || !fitCanvas(this.canvas, this.parts.stage)) return;
      this.render.restart();
      this.loop();
    }).observe(stage);
  }

  syncControls() {
    const { settings, tables, controls } = this;
    const light = tables.environments[settings.env];
    const own = { ...this.surface, f0: this.surface.f0[0] };
    const given = Object.fromEntries(Object.entries(settings).map(([name, value]) => [name, value ?? own[name]]));
    const text = (name, more = "") => number(given[name]) + more + (settings[name] === null ? " (own)" : "");
    const alpha = ` · α ${number(Math.max(given.roughness ** 2, tables.alpha_min))}`;
    const texts = Object.keys(SURFACE).map((name) => [name, text(name, name === "roughness" ? alpha : "")]);
    const shown = { n: this.counts.indexOf(settings.n), mode: this.shown.mode };
    const channels = Object.fromEntries(CHANNELS.map((name, i) => [name, given.albedo[i]]));
    const isOwn = settings.albedo === null ? " (own)" : "";
    controls.show({ ...given, ...shown, ...channels, sheen: hex(given.sheen) }, {
      ...Object.fromEntries(texts),
      ...Object.fromEntries(CHANNELS.map((name) => [name, number(channels[name]) + isOwn])),
      ...{ n: String(settings.n), ev: stopsText(settings.ev) },
      ...{ brightness: text("brightness"), contrast: text("contrast") },
      ...{ anisotropy_turn: text("anisotropy_turn", "°"), turn: text("turn", "°") },
    }); // prettier-ignore
    const { is_stretchable } = tables.lobes[settings.lobe];
    const ways = [settings.method, settings.against];
    const isSampled = ({ name, is_sampled }) => is_sampled && ways.includes(name);
    const used = {
      ...{ n: tables.methods.some(isSampled), bend: ways.includes("split-sum-bent"), anisotropy: is_stretchable },
      ...{ anisotropy_turn: is_stretchable && given.anisotropy, coat_roughness: given.coat },
      sheen_roughness: Math.max(...given.sheen),
    };
    for (const [name, isUsed] of Object.entries(used)) controls.named[name].closest("label").hidden = !isUsed;
    fillErrorLegend(this.parts.legend, this.shown.mode);
    const [finest, prefiltered] = [light, light.prefiltered[0]].map(({ levels }) => levels[0].size.join(" × "));
    say(this.parts.caption, `${light.layout} tables: environment ${finest} texels, prefiltered ${prefiltered}`);
  }

  /** Handles a key; true if the view uses it. */
  key(event) {
    if (this.isEmpty) return false;
    const { ev, mode } = this.settings;
    const [lo, hi] = this.controls.range("ev");
    const show = (wanted) => this.set({ mode: mode === wanted ? "image" : wanted });
    const actions = {
      " ": () => this.hold(true),
      ...{ ArrowLeft: () => this.turn(-5, 0), ArrowRight: () => this.turn(5, 0) },
      ...{ ArrowUp: () => this.turn(0, 5), ArrowDown: () => this.turn(0, -5) },
      "+": () => this.approach(1.15),
      "-": () => this.approach(1 / 1.15),
      0: () => this.set(FRONT),
      "[": () => this.set({ ev: clamp(ev - 0.5, lo, hi) }),
      "]": () => this.set({ ev: clamp(ev + 0.5, lo, hi) }),
      e: () => show("error"),
      s: () => show("signed"),
      d: () => this.set({ split: this.settings.split < 0 ? 0.5 : -1 }),
    };
    this.ways.forEach((method, i) => (actions[i + 1] = () => this.set({ method })));
    const name = event.key.length === 1 ? event.key.toLowerCase().replace("=", "+") : event.key;
    // Space belongs to a button or a box that has the focus.
    if (!(name in actions) || (name === " " && event.target.matches("button, input, a, summary"))) return false;
    if (name !== " " || !event.repeat) actions[name]();
    if (/[1-9es]/.test(name)) announce(`${this.titleOf(this.shown.seen)}, ${this.shown.mode}`);
    return true;
  }

  /** Shows the reference of the method while a key is down. */
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
