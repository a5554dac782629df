// The WebGL2 side of the live view: the run's tables and models on the device, and the renderer's passes over them. The
// build script writes the shaders from the renderer's own libraries (shaders/page); this file binds their inputs.

import { lightTables, shaderText } from "report/data";
import { cameraOf, loadChain, loadPart, makePoints, relativeError } from "report/live-scene";
import { drawOver, errorColors, makePalette, makeProgram, makeTexture, useProgram } from "report/program";

const GBUFFER = ["gbuffer_position", "gbuffer_normal", "gbuffer_tangent", "gbuffer_f0"];
/** Layers of a surface (shaders/page/layers.glsl). */
const [BASE, SHEEN, COAT] = [0, 1, 2];
const ALBEDO_COLUMNS = 256;
/** Time that the samples of one frame may take, ms. */
const FRAME_MS = 24;
const SAMPLES_A_FRAME_MAX = 128;
/** Samples of the reference. It ends when half of its samples differ from all by this small a share of the error. */
const REFERENCE_SAMPLES = 4096;
const ENDS = [256, 1024, REFERENCE_SAMPLES];
const NOISE_SHARE = 0.01;
/** Fewer samples of the reference are not shown, nor scored. */
const START = 32;
/** Share of the time that scores may take while samples are added. */
const SCORE_SHARE = 0.2;

export class LiveRender {
  constructor(canvas) {
    this.canvas = canvas;
    /** The reason why nothing can be drawn; empty if drawing works. */
    this.missing = "";
    this.gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!this.gl) this.missing = "This browser has no WebGL2, which the live view needs.";
    else if (!this.gl.getExtension("EXT_color_buffer_float"))
      this.missing = "This browser's WebGL2 lacks EXT_color_buffer_float, which the live view needs.";
    if (!this.missing) this.reset();
  }

  /** Forgets everything that belonged to a lost context. */
  reset() {
    this.gl.getExtension("EXT_color_buffer_float");
    /** Programs, textures and models by name. */
    this.kept = new Map();
    this.palette = makePalette(this.gl, 0);
    this.targets = null;
    this.fence = null;
    this.batch = 1;
    this.restart();
  }

  keep(key, make) {
    if (!this.kept.has(key)) this.kept.set(key, make());
    return this.kept.get(key);
  }

  /** Loads the content of a view and makes it current. */
  async show(view) {
    const { environments, lobes, models } = lightTables();
    const light = environments[view.env];
    const lobe = lobes[view.lobe];
    const prefiltered = light.prefiltered.find((map) => map.brdf === lobe.brdf);
    const shape = models[view.model];
    const { gl } = this;
    this.wanted = view;
    const named = Object.entries(lobe.tap_tables);
    const [environment, map, dfg, tap_tables, ...parts] = await Promise.all([
      this.keep(`environment ${view.env}`, () => loadChain(gl, light.levels, light.layout)),
      this.keep(`prefiltered ${view.env} ${lobe.brdf}`, () => loadChain(gl, prefiltered.levels, light.layout)),
      this.keep(`dfg ${view.lobe}`, () => loadChain(gl, [lobe.dfg])),
      Promise.all(named.map(async ([name, table]) =>
        [name, await this.keep(`${name} ${view.lobe}`, () => loadChain(gl, [table]))])), // prettier-ignore
      ...shape.parts.map((part, i) => this.keep(`part ${view.model} ${i}`, () => loadPart(gl, part))),
    ]);
    // A later call has overtaken this one.
    if (this.wanted !== view) return false;
    const levelCount = prefiltered.levels.length;
    const tables = { filtered_environment: environment, prefiltered: map, dfg, ...Object.fromEntries(tap_tables) };
    this.view = { ...view, light, lobe, shape, parts, levelCount, tables };
    this.layer();
    this.restart();
    return true;
  }

  /** The surfaces, whose values settings override, as a table with the albedo of their sheen; layers in use. */
  layer() {
    const { gl, view } = this;
    const given = Object.fromEntries(Object.entries(view).filter(([, value]) => value !== null));
    const surfaces = [...view.shape.spheres, ...view.shape.parts].map(({ surface }) => ({ ...surface, ...given }));
    const row = ({ albedo, metallic, sheen, sheen_roughness, coat, coat_roughness }) =>
      [...albedo, metallic, ...sheen, sheen_roughness, coat, coat_roughness, 0, 0]; // prettier-ignore
    const data = Float32Array.from(surfaces.flatMap(row));
    const count = surfaces.length;
    const table = this.keep(`surfaces ${count}`, () => makeTexture(gl, 0, gl.RGBA32F, 3, count, gl.RGBA, gl.FLOAT, null)); // prettier-ignore
    gl.bindTexture(gl.TEXTURE_2D, table);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 3, count, gl.RGBA, gl.FLOAT, data);
    const albedo = this.keep(`albedo ${count}`, () => this.target(ALBEDO_COLUMNS, count));
    Object.assign(view.tables, { surfaces: table, sheen_albedo: albedo.named.color });
    const weights = surfaces.map(({ sheen, coat }) => [1, Math.max(...sheen), coat]);
    view.layers = [BASE, SHEEN, COAT].filter((layer) => weights.some((all) => all[layer] > 0));
    view.hasWidths = view.lobe.is_stretchable && surfaces.some(({ anisotropy }) => anisotropy > 0);
    view.surfaces = surfaces;
    if (!view.layers.includes(SHEEN)) return;
    const inputs = { surfaces: table, points: this.points(REFERENCE_SAMPLES) };
    this.pass("sheen_albedo", albedo, inputs, { ...lightTables().codes, column_count: ALBEDO_COLUMNS });
  }

  points(count) {
    return this.keep(`points ${count}`, () => makePoints(this.gl, count));
  }

  target(width, height, names = ["color"]) {
    const { gl } = this;
    const framebuffer = gl.createFramebuffer();
    const textures = names.map(() => makeTexture(gl, 0, gl.RGBA32F, width, height, gl.RGBA, gl.FLOAT, null));
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const places = names.map((_, i) => gl.COLOR_ATTACHMENT0 + i);
    places.forEach((at, i) => gl.framebufferTexture2D(gl.FRAMEBUFFER, at, gl.TEXTURE_2D, textures[i], 0));
    gl.drawBuffers(places);
    const named = Object.fromEntries(names.map((name, i) => [name, textures[i]]));
    return { framebuffer, textures, width, height, named, depth: null };
  }

  /** Targets of the size of the canvas. */
  resize() {
    const { gl } = this;
    const { width, height } = this.canvas;
    if (this.targets?.gbuffer.width === width && this.targets.gbuffer.height === height) return;
    for (const { framebuffer, textures, depth } of Object.values(this.targets ?? {})) {
      gl.deleteFramebuffer(framebuffer);
      gl.deleteRenderbuffer(depth);
      textures.forEach((texture) => gl.deleteTexture(texture));
    }
    this.targets = {};
    const gbuffer = this.target(width, height, GBUFFER);
    gbuffer.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, gbuffer.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, gbuffer.depth);
    this.targets.gbuffer = gbuffer;
  }

  /** The target with one colour attachment of this name, made if missing. */
  colored(name) {
    const { width, height } = this.targets.gbuffer;
    return (this.targets[name] ??= this.target(width, height));
  }

  program(name, vertex = undefined) {
    return this.keep(`program ${name}`, () => makeProgram(this.gl, name, vertex));
  }

  pass(name, target, textures, values) {
    drawOver(this.gl, this.program(name), target, textures, values);
  }

  get camera() {
    return cameraOf(this.view.shape, this.view, this.canvas.width, this.canvas.height);
  }

  /** A direction in the frame of the environment (Placement::environment_from_world). */
  turned(direction) {
    const angle = (this.view.turn * Math.PI) / 180;
    const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
    const [x, y, z] = direction;
    const before = [cos * x - sin * z, y, sin * x + cos * z];
    const { columns } = lightTables().orientations[this.view.orientation];
    return columns.map((column) => column.reduce((sum, side, i) => sum + side * before[i], 0));
  }

  /** Whether a method reads the DFG table at the alpha of its bend: then its diffuse term differs from others'. */
  usesBend(way) {
    return lightTables().methods.some(({ name, uses_bend }) => name === way && uses_bend);
  }

  /** The diffuse term beside a method, and the environment. */
  surround(way) {
    return this.colored(this.usesBend(way) ? "surround_bent" : "surround");
  }

  /** ShadeParams (src/base/glsl/layout.rs) and constants for a method. */
  params(way, bias = 0, sampleCount = 0, pointCount = 0) {
    const { view, camera } = this;
    const { width, height } = this.targets.gbuffer;
    const values = {
      eye: view.shape.camera.is_perspective ? [...camera.eye, 1] : [...camera.back, 0],
      ...{ width, height, sample_count: sampleCount, point_count: pointCount },
      ...{ lod_bias: bias, prefilter_level_count: view.levelCount },
      environment_scale: view.brightness * view.light.scale,
    };
    // The uniform's rows are the columns of the rotation.
    const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => this.turned(axis)); // prettier-ignore
    for (const i of [0, 1, 2]) values[`environment_from_world_${i}`] = [...columns.map((column) => column[i]), 0];
    const named = Object.entries(values).map(([name, value]) => [`params.${name}`, value]);
    const MASKING = lightTables().masking_names.indexOf(view.lobe.masking);
    const levels = { LEVEL_BEND: view.light.level_bend, LEVEL_ROUGHNESSES: view.light.level_roughnesses };
    const tables = { MASKING, ...levels, DFG_AXES: view.lobe.dfg_axes };
    const { codes, bends } = lightTables();
    const layers = {
      ...codes,
      BEND: bends[this.usesBend(way) ? view.bend : "none"],
      ANISOTROPY: view.hasWidths ? codes.ANISOTROPY : 0,
    };
    return { ...Object.fromEntries(named), ...tables, ...layers };
  }

  /** Makes a program of the g-buffer current; returns a setter of surfaces. */
  startSurface(name, values, vertex = undefined) {
    const { view, camera } = this;
    const { gbuffer } = this.targets;
    const made = this.program(name, vertex);
    useProgram(this.gl, made, gbuffer, {}, {
      "camera.right": [...camera.right, camera.extent[0]],
      "camera.up": [...camera.up, camera.extent[1]],
      "camera.forward": [...camera.forward, camera.depth[0]],
      "camera.eye": [...camera.eye, view.shape.camera.is_perspective ? 1 : 0],
      ...{ "camera.depth_offset": camera.depth[1], "camera.width": gbuffer.width, "camera.height": gbuffer.height },
      ...values,
    }); // prettier-ignore
    return (i) => {
      const { albedo, metallic, f0, roughness, anisotropy, anisotropy_turn } = view.surfaces[i];
      const turn = (anisotropy_turn * Math.PI) / 180;
      made.set["material.albedo_metallic"]([...albedo, metallic]);
      made.set["material.f0_alpha"](f0.length ? [...f0, 0] : [f0, f0, f0, 0]);
      made.set["material.tangent"]([Math.cos(turn), Math.sin(turn), anisotropy, 0]);
      made.set.perceptual_roughness(roughness);
      made.set.surface_index(i);
      return made.set;
    };
  }

  drawSurfaces() {
    const { gl, view } = this;
    const { low, high, spheres } = view.shape;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targets.gbuffer.framebuffer);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    // Row 0 is the top, so counter-clockwise is the other way round.
    gl.frontFace(gl.CW);
    const sphere = spheres.length && this.startSurface("sphere", {});
    spheres.forEach(({ center, radius }, i) => {
      sphere(i).sphere([...center, radius]);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    });
    const mesh = view.parts.length && this.startSurface("mesh", { low, high }, shaderText("mesh.vert"));
    view.parts.forEach(({ vertices, count }, i) => {
      mesh(spheres.length + i);
      gl.bindVertexArray(vertices);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_SHORT, 0);
    });
    gl.bindVertexArray(null);
    gl.disable(gl.DEPTH_TEST);
  }

  /** Inputs of the passes after the g-buffer. */
  get inputs() {
    return { ...this.targets.gbuffer.named, ...this.view.tables };
  }

  /** Mean luminance of the light, of which epsilon is a share (metrics::Epsilon). */
  get lightMean() {
    return this.view.light.mean_luminance * this.view.brightness || 1;
  }

  /** Everything but the samples. */
  drawBase() {
    const { view, camera } = this;
    const { width, height } = this.targets.gbuffer;
    this.drawSurfaces();
    // Parallel rays would show one colour: behind an orthographic view the environment is seen in perspective.
    const half = Math.tan((lightTables().fov_deg * Math.PI) / 360);
    const extent = view.shape.camera.is_perspective ? camera.extent : [(half * width) / height, half];
    const row = (axis, by) => [...this.turned(axis.map((side) => side * by)), 0];
    const bent = lightTables().methods.filter(({ uses_bend }) => uses_bend);
    for (const way of ["reference", ...bent.map(({ name }) => name)])
      this.pass(`surround:${view.light.layout}`, this.surround(way), this.inputs, {
        ...this.params(way),
        "background.right": row(camera.right, extent[0]),
        "background.up": row(camera.up, extent[1]),
        "background.forward": row(camera.forward, 1),
        ...{ "background.width": width, "background.height": height },
        "background.environment_scale": view.brightness * view.light.scale,
        has_diffuse: view.diffuse,
        coefficients: view.light.sh9.flatMap((c) => [...c, 0]),
      });
  }

  /** Adds `count` samples of a method. The reference is the last method that takes samples. */
  drawSamples(way, count) {
    const { view, targets, done } = this;
    const { methods } = lightTables();
    const { name } = methods.find((one) => one.name === way) ?? methods.findLast((one) => one.is_sampled);
    const total = this.total(way);
    const { layout } = view.light;
    const plain = `specular:${layout}:${name}`;
    const shader = shaderText(plain) ? plain : `${plain}:${view.lobe.brdf}`;
    const ofSheen = way === "reference" ? `sheen:${layout}` : `specular:${layout}:sheen-lookup`;
    const params = this.params(way, way === "reference" ? 0 : view.bias, total, count);
    for (const layer of view.layers) {
      const [before, after, half] = [way, "spare", "half"].map((one) => this.colored(one));
      const inputs = { ...this.inputs, points: this.points(total), so_far: before.named.color };
      const ANISOTROPY = layer === BASE ? params.ANISOTROPY : 0;
      const values = { ...params, ANISOTROPY, layer, first_sample: done[way] };
      this.pass(layer === SHEEN ? ofSheen : shader, after, inputs, values);
      // Keeps half of the samples of each stopping point: they give the reference's own noise.
      const isHalf = layer === BASE && way === "reference" && ENDS.includes(2 * done.reference);
      Object.assign(targets, isHalf ? { half: before, spare: half } : { spare: before }, { [way]: after });
      if (isHalf) done.half = done.reference;
    }
    done[way] += count;
  }

  /**
   * Compares the method with its reference by the samples so far. Once both are ready, the reference's own error is
   * estimated from half of its samples against all of them, as if they were independent.
   */
  judge() {
    const { method, against } = this.view;
    const { reference } = this.done;
    const isThere = (way) => (way === "reference" ? ENDS.includes(reference) : this.done[way] === this.total(way));
    if (this.isJudged || this.errors?.at === reference || ![method, against].every((way) => this.isStarted(way)))
      return;
    const start = performance.now();
    const isWhole = [method, against].every(isThere);
    if (!isWhole && start < this.nextScore) return;
    const errorOf = (way, truth) => relativeError(this.linear(way), this.linear(truth), this.lightMean);
    const own = errorOf(method, against);
    this.nextScore = performance.now() + (performance.now() - start) / SCORE_SHARE;
    if (!isWhole) {
      this.errors = { own, noise: 0, at: -1 };
      return;
    }
    const noise = [method, against].includes("reference") ? errorOf("half", "reference") : 0;
    this.errors = { own, noise, at: reference };
    this.isJudged = noise <= NOISE_SHARE * own || reference === REFERENCE_SAMPLES;
  }

  /** Shows a method on the canvas, as an image or as its error; or writes its linear values. */
  drawResult(way, mode, isLinear = false) {
    const { against } = this.view;
    const share = (name) => this.total(name) / Math.max(1, this.done[name]);
    const [test, truth] = [way, against].map((one) => this.colored(one).named.color);
    const [test_surround, truth_surround] = [way, against].map((one) => this.surround(one).named.color);
    const surrounds = { test_surround, truth_surround };
    const textures = { ...this.targets.gbuffer.named, ...surrounds, test, truth, palette: this.palette };
    this.pass("show", isLinear ? this.colored("linear") : this.canvas, textures, {
      ...{ test_share: share(way), truth_share: share(against) },
      ...{ mode: ["image", "error", "signed"].indexOf(mode), is_linear: isLinear },
      ...{ canvas_height: this.canvas.height, exposure: 2 ** this.view.ev, contrast: this.view.contrast },
      ...errorColors(this.lightMean),
    });
  }

  /** Shows the other side right of the wipe. */
  drawRight(wipe) {
    const { gl } = this;
    const { width, height } = this.canvas;
    const left = Math.round(wipe * width);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(left, 0, width - left, height);
    this.drawResult(this.view.against, "image");
    gl.disable(gl.SCISSOR_TEST);
  }

  /** Marks the drawn image as outdated. */
  restart() {
    this.isStale = true;
    const ways = [...lightTables().methods.map(({ name }) => name), "reference", "half"];
    this.done = Object.fromEntries(ways.map((way) => [way, 0]));
    this.forget();
  }

  /** Marks the comparison as outdated. */
  forget() {
    this.errors = null;
    this.nextScore = 0;
    this.isJudged = false;
    this.isShown = false;
  }

  /** Changes what acts after shading. */
  display(details) {
    if (this.view) Object.assign(this.view, details);
    this.isShown = false;
    if ("method" in details || "against" in details) this.forget();
  }

  /** Sample count of a method: 1 for a method without samples; any other name is the reference. */
  total(way) {
    const method = lightTables().methods.find(({ name }) => name === way);
    return !method ? REFERENCE_SAMPLES : method.is_sampled ? this.view.n : 1;
  }

  isStarted(way) {
    return this.done[way] >= Math.min(START, this.total(way));
  }

  /** The method that needs samples now; undefined if none does. */
  get missingWay() {
    const { method, against } = this.view;
    const isOpen = (way) => way !== "reference" && this.done[way] < this.total(way);
    return [method, against].find(isOpen) ?? (this.isJudged ? undefined : "reference");
  }

  get isComplete() {
    return !this.isStale && !this.missingWay;
  }

  /** Draws as much as fits a frame. Does nothing and returns false while the last frame is still being drawn. */
  step(isMoving) {
    const { gl } = this;
    if (this.fence) {
      if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
      gl.deleteSync(this.fence);
      this.adapt(performance.now() - this.submitted);
    }
    this.resize();
    if (this.isStale) {
      this.restart();
      this.drawBase();
      this.isStale = false;
    }
    const { method, against, seen, mode, wipe } = this.view;
    for (const one of [method, against]) if (this.total(one) === 1 && !this.done[one]) this.drawSamples(one, 1);
    this.judge();
    const way = this.missingWay;
    const isSeen = way === seen || mode !== "image" || wipe !== null;
    this.lastCount = 0;
    if (way && (isSeen || !isMoving)) {
      const ends = way === "reference" ? ENDS.flatMap((n) => [n / 2, n]) : [this.total(way)];
      this.lastCount = Math.min(this.batch, ends.find((end) => end > this.done[way]) - this.done[way]);
      this.drawSamples(way, this.lastCount);
      this.isShown &&= !isSeen;
    }
    if (!this.isShown) this.drawResult(seen, mode);
    if (!this.isShown && wipe !== null && this.isStarted(against)) this.drawRight(wipe);
    this.isShown = true;
    this.submitted = performance.now();
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    return true;
  }

  /** Fits the samples of a frame to the time that the last one took. */
  adapt(ms) {
    if (!this.lastCount) return;
    const factor = Math.min(2, Math.max(0.25, FRAME_MS / Math.max(1, ms)));
    this.batch = Math.max(1, Math.min(SAMPLES_A_FRAME_MAX, Math.round(this.lastCount * factor)));
  }

  /** Linear RGB of a way and 1 where a surface is hit, top row first: the whole image, or one pixel. */
  linear(way, pixel = null) {
    const { gl } = this;
    const { width, height } = this.colored("linear");
    const box = pixel ? [...pixel, 1, 1] : [0, 0, width, height];
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(box[0], box[1], box[2], box[3]);
    this.drawResult(way, "image", true);
    gl.disable(gl.SCISSOR_TEST);
    const values = new Float32Array(4 * box[2] * box[3]);
    gl.readPixels(box[0], box[1], box[2], box[3], gl.RGBA, gl.FLOAT, values);
    return values;
  }
}
