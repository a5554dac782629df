// The WebGL2 side of the live view: the run's tables as textures, and the renderer's passes over them. The shaders are written by the
// build script from the renderer's own libraries (shaders/page); here are only bindings, the order of passes and the camera.

import { base64Bytes, decode, lightTables, model } from "report/data";
import { drawOver, makePalette, makeProgram, makeTexture, setErrorColors } from "report/program";

const GBUFFER = ["gbuffer_position", "gbuffer_normal", "gbuffer_albedo", "gbuffer_f0"];
/** Time that the samples of one frame may take, ms. */
const FRAME_MS = 24;
/** While the view moves, a frame of one sample is drawn with so few pixels that it takes about this long, ms, where all take longer. */
const MOVING_MS = 40;
const SAMPLES_A_FRAME_MAX = 128;
/** Bands of rows in which one sample of every pixel is drawn where it takes longer than a frame may. */
const BANDS_MAX = 24;
/** Sides of a drawn pixel, in canvas pixels, while the view moves. */
const PIXEL_SIDE_MAX = 6;
/** What there is to see: sphere (centre, radius) and rectangle (height, half sides). A size of 0 leaves one out. */
export const OBJECTS = {
  both: { sphere: [0, 0, 0, 1], rectangle: [-1, 3, 3] },
  sphere: { sphere: [0, 0, 0, 1], rectangle: [0, 0, 0] },
  plane: { sphere: [0, 0, 0, 0], rectangle: [0, 1, 2] },
};
export const MODES = ["split", "sampled", "error", "signed"];

/** Right, up and forward of a camera that looks at the origin, its eye and the half sides of the image plane at distance 1. */
export function cameraOf({ yaw, pitch, distance }, width, height) {
  const { fov_deg: fov, distance: unit } = lightTables().camera;
  const [a, b] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180);
  const [sa, ca, sb, cb] = [Math.sin(a), Math.cos(a), Math.sin(b), Math.cos(b)];
  // A tall image fits the width, as the renderer's automatic camera does.
  const half = Math.tan((fov * Math.PI) / 360) * Math.max(1, height / width);
  return {
    right: [ca, 0, -sa],
    up: [-sa * sb, cb, -ca * sb],
    forward: [-sa * cb, -sb, -ca * cb],
    eye: [sa * cb, sb, ca * cb].map((x) => x * unit * distance),
    extent: [(half * width) / height, half],
  };
}

export class LiveRender {
  constructor(canvas) {
    this.canvas = canvas;
    /** Why nothing can be drawn; empty when all is there. */
    this.missing = "";
    this.gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!this.gl) this.missing = "This browser has no WebGL2, which the live view needs.";
    else if (!this.gl.getExtension("EXT_color_buffer_float"))
      this.missing =
        "This browser's WebGL2 has no float colour buffers (EXT_color_buffer_float), which the live view needs to sum samples.";
    if (!this.missing) this.reset();
  }

  /** Forgets everything that belonged to a lost context. */
  reset() {
    const { gl } = this;
    gl.getExtension("EXT_color_buffer_float");
    this.programs = new Map();
    this.chains = new Map();
    this.pointTables = new Map();
    this.targets = null;
    this.palette = makePalette(gl, 0, model.colors);
    this.done = 0;
    this.batch = 1;
    this.bands = 1;
    this.pending = null;
    this.isShown = false;
    this.pixelSide = 1;
    this.movingSide = 1;
    this.frameMs = 0;
    this.fence = null;
    this.stale = true;
  }

  // --- Textures ------------------------------------------------------------------------------------------------------------

  /** Packed levels as one trilinear texture; u repeats on an equirectangular map, as in the renderer. */
  async chain(key, levels, wraps) {
    if (!this.chains.has(key)) {
      const load = async () => {
        const images = await Promise.all(levels.map(({ size, base64 }) => decode(base64, ...size)));
        const { gl } = this,
          texture = gl.createTexture();
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, images.length, gl.RGBA16F, images[0].width, images[0].height);
        images.forEach(({ width, height, rgba }, level) =>
          gl.texSubImage2D(gl.TEXTURE_2D, level, 0, 0, width, height, gl.RGBA, gl.HALF_FLOAT, rgba),
        );
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, images.length > 1 ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wraps ? gl.REPEAT : gl.CLAMP_TO_EDGE);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        return texture;
      };
      this.chains.set(key, load());
    }
    return this.chains.get(key);
  }

  /** Loads the tables of a view and makes it the one that is drawn. */
  async show(view) {
    const tables = lightTables(),
      light = tables.environments[view.environment];
    const lobe = tables.lobes.find((one) => one.brdf === view.brdf && one.masking === view.masking);
    const prefiltered = light.prefiltered.find((map) => map.brdf === view.brdf);
    this.wanted = view;
    const [environment, map, dfg] = await Promise.all([
      this.chain(`environment ${view.environment}`, light.levels, true),
      this.chain(`prefiltered ${view.environment} ${view.brdf}`, prefiltered.levels, true),
      this.chain(`dfg ${view.brdf} ${view.masking}`, [lobe.dfg], false),
    ]);
    // A later call has overtaken this one.
    if (this.wanted !== view) return false;
    this.view = { ...view, light, levelCount: prefiltered.levels.length, environment, prefiltered: map, dfg };
    this.restart();
    return true;
  }

  /** The renderer's sample points of a count, in an order of which every beginning covers the whole lobe. */
  points(count) {
    if (!this.pointTables.has(count)) {
      const { gl } = this;
      const table = new Float32Array(
        base64Bytes(lightTables().points.find((one) => one.count === count).base64).buffer,
      );
      const divisor = (a, b) => (b ? divisor(b, a % b) : a);
      let step = Math.max(1, Math.round(count * 0.618));
      while (divisor(step, count) !== 1) step++;
      const shuffled = new Float32Array(table.length);
      for (let i = 0; i < count; i++)
        shuffled.set(table.subarray(4 * ((i * step) % count), 4 * ((i * step) % count) + 4), 4 * i);
      this.pointTables.set(count, makeTexture(gl, 0, gl.RGBA32F, count, 1, gl.RGBA, gl.FLOAT, shuffled));
    }
    return this.pointTables.get(count);
  }

  // --- Passes --------------------------------------------------------------------------------------------------------------

  target(width, height, names) {
    const { gl } = this,
      framebuffer = gl.createFramebuffer();
    const textures = names.map(() => makeTexture(gl, 0, gl.RGBA32F, width, height, gl.RGBA, gl.FLOAT, null));
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    textures.forEach((texture, i) =>
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0),
    );
    gl.drawBuffers(names.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    return {
      framebuffer,
      textures,
      width,
      height,
      named: Object.fromEntries(names.map((name, i) => [name, textures[i]])),
    };
  }

  /** Targets of the size in which the view is drawn now. */
  resize() {
    const [width, height] = [this.canvas.width, this.canvas.height].map((side) =>
      Math.max(1, Math.ceil(side / this.pixelSide)),
    );
    if (this.targets?.gbuffer.width === width && this.targets.gbuffer.height === height) return;
    const { gl } = this,
      old = this.targets;
    for (const { framebuffer, textures } of old
      ? [old.gbuffer, old.surround, old.split, ...old.sums, old.linear]
      : []) {
      gl.deleteFramebuffer(framebuffer);
      textures.forEach((texture) => gl.deleteTexture(texture));
    }
    const one = () => this.target(width, height, ["color"]);
    this.targets = {
      gbuffer: this.target(width, height, GBUFFER),
      surround: one(),
      split: one(),
      sums: [one(), one()],
      linear: one(),
    };
  }

  /** Draws one shader over `target` (null: the canvas) with the named textures; `set` fills the other uniforms. */
  pass(name, target, textures, set) {
    const { gl } = this;
    if (!this.programs.has(name)) this.programs.set(name, makeProgram(gl, name));
    const { width, height } = target ?? this.canvas;
    drawOver(gl, this.programs.get(name), target?.framebuffer ?? null, [width, height], textures, set);
  }

  /** A direction in the frame of the environment, which is turned by `rotation` degrees about +y (shade::pass::environment_from_world). */
  turned(direction) {
    const [x, y, z] = direction;
    const angle = (this.view.rotation * Math.PI) / 180,
      [sin, cos] = [Math.sin(angle), Math.cos(angle)];
    return [cos * x - sin * z, y, sin * x + cos * z];
  }

  /** ShadeParams (src/glsl/layout.rs). */
  setParams(uniform, camera) {
    const { gl, view } = this,
      { light } = view,
      { width, height } = this.targets.gbuffer;
    const set = (name, kind, ...values) => gl[`uniform${kind}`](uniform[`params.${name}`], ...values);
    // The columns of the rotation, as the rows of what is handed over.
    const columns = [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ].map((axis) => this.turned(axis));
    [0, 1, 2].forEach((i) => set(`environment_from_world_${i}`, "4fv", [...columns.map((column) => column[i]), 0]));
    set("eye", "4fv", [...camera.eye, 1]);
    set("width", "1ui", width);
    set("height", "1ui", height);
    // The renderer's levels are those of the whole environment; the page's begin later.
    set("environment_width", "1ui", light.size[0]);
    set("environment_height", "1ui", light.size[1]);
    set("lod_bias", "1f", view.bias - light.first_level);
    set("sample_count", "1ui", view.samples);
    set("prefilter_level_count", "1ui", view.levelCount);
    set("environment_scale", "1f", view.brightness * light.scale);
    set("flags", "1ui", 0);
    gl.uniform1ui(uniform.MASKING, lightTables().masking_names.indexOf(view.masking));
  }

  /** Everything but the samples. */
  drawBase() {
    const { gl, view, targets } = this,
      { gbuffer } = targets;
    const camera = cameraOf(view, this.canvas.width, this.canvas.height),
      { sphere, rectangle } = OBJECTS[view.object];
    const shared = { ...gbuffer.named, environment: view.environment, prefiltered: view.prefiltered, dfg: view.dfg };
    this.pass("gbuffer", gbuffer, {}, (uniform) => {
      const set = (name, value) => gl.uniform4fv(uniform[`camera.${name}`], value);
      set("right", [...camera.right, camera.extent[0]]);
      set("up", [...camera.up, camera.extent[1]]);
      set("forward", [...camera.forward, 0]);
      set("eye", [...camera.eye, 1]);
      gl.uniform1ui(uniform["camera.width"], gbuffer.width);
      gl.uniform1ui(uniform["camera.height"], gbuffer.height);
      gl.uniform4fv(uniform["material.albedo_metallic"], [...view.albedo, view.metallic]);
      gl.uniform4fv(uniform["material.f0_alpha"], [view.f0, view.f0, view.f0, 0]);
      gl.uniform1f(uniform.perceptual_roughness, view.roughness);
      gl.uniform4fv(uniform.sphere, sphere);
      gl.uniform3fv(uniform.rectangle, rectangle);
    });
    this.pass("surround", targets.surround, shared, (uniform) => {
      this.setParams(uniform, camera);
      const scaled = (axis, by) => this.turned(axis.map((x) => x * by));
      gl.uniform4fv(uniform["background.right"], [...scaled(camera.right, camera.extent[0]), 0]);
      gl.uniform4fv(uniform["background.up"], [...scaled(camera.up, camera.extent[1]), 0]);
      gl.uniform4fv(uniform["background.forward"], [...this.turned(camera.forward), 0]);
      gl.uniform1ui(uniform["background.width"], gbuffer.width);
      gl.uniform1ui(uniform["background.height"], gbuffer.height);
      gl.uniform1f(uniform["background.environment_scale"], view.brightness * view.light.scale);
      gl.uniform1i(uniform.has_diffuse, view.diffuse ? 1 : 0);
      gl.uniform4fv(
        uniform.coefficients,
        view.light.sh9.flatMap((c) => [...c, 0]),
      );
    });
    this.pass("split_sum", targets.split, shared, (uniform) => this.setParams(uniform, camera));
  }

  /** Adds `count` samples to those that are done, in one of `bands` bands of rows; they count when the last band is drawn. */
  drawSamples(count, band = 0, bands = 1) {
    const { gl, view, targets } = this,
      [from, to] = targets.sums;
    const shared = {
      ...targets.gbuffer.named,
      environment: view.environment,
      points: this.points(view.samples),
      so_far: from.named.color,
    };
    const row = (i) => Math.round((i * to.height) / bands);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, row(band), to.width, row(band + 1) - row(band));
    this.pass(`sampled:${view.brdf}`, to, shared, (uniform) => {
      this.setParams(uniform, cameraOf(view, this.canvas.width, this.canvas.height));
      gl.uniform1ui(uniform.first_sample, this.done);
      gl.uniform1ui(uniform["params.point_count"], count);
      gl.uniform1i(uniform.is_filtered, view.filtered ? 1 : 0);
    });
    gl.disable(gl.SCISSOR_TEST);
    if (band + 1 < bands) return;
    targets.sums.reverse();
    this.done += count;
  }

  /** Shows what is there: on the canvas, or as linear values. */
  drawResult(mode, isLinear) {
    const { gl, view, targets } = this;
    const textures = {
      gbuffer_position: targets.gbuffer.named.gbuffer_position,
      surround: targets.surround.named.color,
      split_sum: targets.split.named.color,
      sampled: targets.sums[0].named.color,
      palette: this.palette,
    };
    this.pass("show", isLinear ? targets.linear : null, textures, (uniform) => {
      gl.uniform1i(uniform.mode, MODES.indexOf(mode));
      gl.uniform1f(uniform.sample_share, this.done ? view.samples / this.done : 0);
      gl.uniform1i(uniform.is_linear, isLinear ? 1 : 0);
      gl.uniform1f(uniform.pixel_side, isLinear ? 1 : this.pixelSide);
      gl.uniform1f(uniform.canvas_height, this.canvas.height);
      gl.uniform1i(uniform.tone, 0);
      gl.uniform1f(uniform.exposure, 2 ** view.stops);
      gl.uniform1f(uniform.contrast, view.contrast);
      setErrorColors(gl, uniform, model.colors);
    });
  }

  // --- Time ----------------------------------------------------------------------------------------------------------------

  /** What is drawn is no longer what is wanted. */
  restart() {
    this.stale = true;
    this.done = 0;
    this.pending = null;
  }

  /** Changes what acts after shading: mode and tone curve. */
  display(details) {
    if (this.view) Object.assign(this.view, details);
    this.isShown = false;
  }

  get isSampling() {
    return this.view.mode !== "split";
  }

  get isComplete() {
    return !this.stale && this.pixelSide === 1 && (!this.isSampling || this.done >= this.view.samples);
  }

  /** Draws as much as fits a frame. False while the last frame is still being drawn: then nothing is done. */
  step(isMoving) {
    const { gl } = this;
    if (this.fence) {
      if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
      gl.deleteSync(this.fence);
      this.fence = null;
      this.adapt(performance.now() - this.submitted);
    }
    const side = isMoving ? this.movingSide : 1;
    if (side !== this.pixelSide) {
      this.pixelSide = side;
      this.restart();
    }
    this.resize();
    this.lastCount = 0;
    // Every pass is drawn, as it is in every frame while the view moves.
    this.wasWhole = this.stale;
    if (this.stale) {
      this.restart();
      this.drawBase();
      this.stale = false;
      this.isShown = false;
    }
    if (this.isSampling && this.done < this.view.samples) this.sampleSome();
    if (!this.isShown) this.drawResult(this.view.mode, false);
    this.isShown = true;
    this.submitted = performance.now();
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    return true;
  }

  /** One pass of samples, or a band of it where a pass takes longer than a frame may. */
  sampleSome() {
    this.pending ??= {
      count: Math.min(this.batch, this.view.samples - this.done),
      band: 0,
      bands: this.wasWhole ? 1 : this.bands,
    };
    const { count, band, bands } = this.pending;
    this.drawSamples(count, band, bands);
    this.lastCount = count;
    this.lastBands = bands;
    this.pending.band += 1;
    if (this.pending.band < bands) return;
    this.pending = null;
    this.isShown = false;
  }

  /** Fits the samples a frame, and the pixels while moving, to the time that the last frame took. */
  adapt(ms) {
    this.frameMs = ms;
    if (this.lastCount) {
      const pass = Math.max(1, ms) * this.lastBands,
        factor = Math.min(2, Math.max(0.25, FRAME_MS / pass));
      this.batch = Math.max(1, Math.min(SAMPLES_A_FRAME_MAX, Math.round(this.lastCount * factor)));
      this.bands = this.lastCount === 1 ? Math.max(1, Math.min(BANDS_MAX, Math.round(pass / FRAME_MS))) : 1;
    }
    if (!this.wasWhole) return;
    const allPixels = (ms / Math.max(1, this.lastCount)) * this.pixelSide ** 2;
    this.movingSide = Math.min(PIXEL_SIDE_MAX, Math.max(1, Math.ceil(Math.sqrt(allPixels / MOVING_MS))));
  }

  // --- Values --------------------------------------------------------------------------------------------------------------

  /** Linear RGBA of `mode` ("split" or "sampled"), top row first: the whole image, or one pixel of the canvas. */
  linear(mode, pixel) {
    const { gl } = this,
      { width, height } = this.targets.linear;
    // While the view moves, one shaded pixel stands for a square of them.
    const at = pixel?.map((place, i) => Math.min([width, height][i] - 1, Math.floor(place / this.pixelSide)));
    const [x, y, w, hh] = at ? [...at, 1, 1] : [0, 0, width, height];
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(x, y, w, hh);
    this.drawResult(mode, true);
    gl.disable(gl.SCISSOR_TEST);
    const values = new Float32Array(4 * w * hh);
    gl.readPixels(x, y, w, hh, gl.RGBA, gl.FLOAT, values);
    return values;
  }

  /** 1 where a surface is hit, top row first. */
  mask() {
    const { gl } = this,
      { framebuffer, width, height } = this.targets.gbuffer;
    const values = new Float32Array(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.readBuffer(gl.COLOR_ATTACHMENT0);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
    return values.filter((_, i) => i % 4 === 3);
  }

  /** Mean squared relative error of the split sum against the samples over the surface: the formula of the headline metric. */
  relativeError(squaredError) {
    const [test, truth, mask] = [this.linear("split"), this.linear("sampled"), this.mask()];
    let sum = 0,
      count = 0;
    for (let i = 0; i < mask.length; i++) {
      if (!mask[i]) continue;
      sum += squaredError(test.subarray(4 * i, 4 * i + 3), truth.subarray(4 * i, 4 * i + 3));
      count++;
    }
    return count ? sum / count : NaN;
  }
}
