// The WebGL2 side of the comparison: the images as half-float textures, shaded once for each setting, and placed on the canvas.

import { mask, model, pixels } from "report/data";
import { drawOver, keepContext, makePalette, makeProgram, makeTexture, setErrorColors } from "report/program";

/** Images kept as textures; older scenes are freed. */
const TEXTURE_MAX = 96;
/** Texels of shaded images kept, so that flipping back and forth only places them. */
const SHADED_TEXELS_MAX = 16e6;
/** Uploads bind here, so that they leave the units of the drawing alone. */
const UPLOAD_UNIT = 7;
const BACKGROUND = { light: [0.93, 0.93, 0.925], dark: [0.06, 0.063, 0.07] };
const isDark = matchMedia("(prefers-color-scheme: dark)");

export class Surface {
  /** `onrestored` is called when a lost context is back and everything is to be drawn again. */
  constructor(canvas, onrestored) {
    this.canvas = canvas;
    /** Image index to {index, width, height, rgba, texture, mask, maskBytes}. */
    this.images = new Map();
    /** Images that are not to be freed. */
    this.wanted = new Set();
    this.gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!this.gl) return;
    this.setUp();
    keepContext(canvas, () => {
      this.images.clear();
      this.setUp();
      onrestored();
    });
  }

  setUp() {
    const { gl } = this;
    this.viewer = makeProgram(gl, "viewer");
    this.place = makeProgram(gl, "place");
    this.palette = makePalette(gl, UPLOAD_UNIT, model.colors);
    this.noMask = makeTexture(gl, UPLOAD_UNIT, gl.R8, 1, 1, gl.RED, gl.UNSIGNED_BYTE, Uint8Array.of(255));
    this.framebuffer = gl.createFramebuffer();
    /** "image reference" to {texture, texels}, least recently used first. */
    this.shadings = new Map();
    this.settings = "";
  }

  /** Decodes and uploads an image once; a promise of its entry, null when no pixels are embedded. */
  async load(index) {
    if (this.images.has(index)) return this.images.get(index);
    const { gl } = this,
      [image, bytes] = await Promise.all([pixels(index), mask(index)]);
    if (!image) return null;
    // Another call may have been faster.
    if (this.images.has(index)) return this.images.get(index);
    const entry = {
      ...image,
      index,
      maskBytes: bytes,
      mask: this.noMask,
      texture: makeTexture(gl, UPLOAD_UNIT, gl.RGBA16F, image.width, image.height, gl.RGBA, gl.HALF_FLOAT, image.rgba),
    };
    if (bytes)
      entry.mask = makeTexture(
        gl,
        UPLOAD_UNIT,
        gl.R8,
        image.width,
        image.height,
        gl.RED,
        gl.UNSIGNED_BYTE,
        bytes.map((b) => b * 255),
      );
    this.images.set(index, entry);
    this.free();
    return entry;
  }

  free() {
    for (const [index, entry] of this.images) {
      if (this.images.size <= TEXTURE_MAX) return;
      if (this.wanted.has(index)) continue;
      this.gl.deleteTexture(entry.texture);
      if (entry.mask !== this.noMask) this.gl.deleteTexture(entry.mask);
      this.images.delete(index);
    }
  }

  /** An image as it is to be seen, as a texture: shaded now, or kept from before. */
  shaded(image, reference, look) {
    const { gl } = this,
      { mode, tone, exposure, contrast } = look,
      settings = [mode, tone, exposure, contrast].join(" ");
    if (settings !== this.settings) this.forget(0);
    this.settings = settings;
    // Only an error depends on the reference.
    const key = mode === 0 ? `${image.index}` : `${image.index} ${reference.index}`;
    let entry = this.shadings.get(key);
    this.shadings.delete(key);
    if (!entry) {
      const texels = image.width * image.height;
      this.forget(SHADED_TEXELS_MAX - texels);
      entry = {
        texels,
        texture: makeTexture(gl, UPLOAD_UNIT, gl.RGBA8, image.width, image.height, gl.RGBA, gl.UNSIGNED_BYTE, null),
      };
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, entry.texture, 0);
      const textures = {
        image: image.texture,
        reference: reference.texture,
        mask: reference.mask,
        palette: this.palette,
      };
      drawOver(gl, this.viewer, this.framebuffer, [image.width, image.height], textures, (uniform) => {
        gl.uniform1i(uniform.mode, mode);
        gl.uniform1i(uniform.tone, tone);
        gl.uniform1f(uniform.exposure, exposure);
        gl.uniform1f(uniform.contrast, contrast);
        setErrorColors(gl, uniform, model.colors);
      });
    }
    this.shadings.set(key, entry);
    return entry.texture;
  }

  /** Frees shaded images, the oldest first, until no more than `texels` are kept. */
  forget(texels) {
    let kept = [...this.shadings.values()].reduce((sum, entry) => sum + entry.texels, 0);
    for (const [key, entry] of this.shadings) {
      if (kept <= Math.max(0, texels)) return;
      kept -= entry.texels;
      this.gl.deleteTexture(entry.texture);
      this.shadings.delete(key);
    }
  }

  /** Draws at once. `split` is a share of the width, or null. */
  draw({ left, right, reference, rightReference, origin, scale, split, clipped, ...settings }) {
    const { gl, canvas } = this;
    const leftImage = this.shaded(left, reference, settings);
    const rightImage = split === null ? leftImage : this.shaded(right, rightReference, settings);
    drawOver(
      gl,
      this.place,
      null,
      [canvas.width, canvas.height],
      { left_image: leftImage, right_image: rightImage },
      (uniform) => {
        gl.uniform2f(uniform.canvas_size, canvas.width, canvas.height);
        gl.uniform2fv(uniform.origin, origin);
        gl.uniform1f(uniform.scale, scale);
        gl.uniform1f(uniform.split, split === null ? 1e9 : split * canvas.width);
        gl.uniform1i(uniform.shows_clipped, clipped ? 1 : 0);
        gl.uniform3fv(uniform.background, BACKGROUND[isDark.matches ? "dark" : "light"]);
      },
    );
  }
}
