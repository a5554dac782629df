// The WebGL2 side of the comparison: images as half-float textures, shaded once a setting, and placed on the canvas.

import { mask, model, pixels } from "report/data";
import { drawOver, errorColors, keepContext, makePalette, makeProgram, makeTexture } from "report/program";

/** Images kept as textures; older scenes are freed. */
const TEXTURE_MAX = 96;
/** Uploads bind to this unit, so that they do not change the units used for drawing. */
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
    this.palette = makePalette(gl, UPLOAD_UNIT);
    this.noMask = this.upload(gl.R8, 1, 1, gl.RED, gl.UNSIGNED_BYTE, Uint8Array.of(255));
    this.framebuffer = gl.createFramebuffer();
    /** The textures that the two sides are shaded into, with their sizes. */
    this.sides = [{}, {}];
  }

  upload(internal, width, height, format, type, data) {
    return makeTexture(this.gl, UPLOAD_UNIT, internal, width, height, format, type, data);
  }

  /** Decodes and uploads an image once; a promise of its entry, null when no pixels are embedded. */
  async load(index) {
    const [image, bytes] = await Promise.all([pixels(index), mask(index)]);
    if (!image || this.images.has(index)) return this.images.get(index) ?? null;
    const { gl } = this;
    const { width, height, rgba } = image;
    const texture = this.upload(gl.RGBA16F, width, height, gl.RGBA, gl.HALF_FLOAT, rgba);
    const counted = bytes?.map((b) => b * 255);
    const own = counted ? this.upload(gl.R8, width, height, gl.RED, gl.UNSIGNED_BYTE, counted) : this.noMask;
    this.images.set(index, { ...image, index, maskBytes: bytes, mask: own, texture });
    for (const [other, entry] of this.images) {
      if (this.images.size <= TEXTURE_MAX) break;
      if (this.wanted.has(other)) continue;
      gl.deleteTexture(entry.texture);
      if (entry.mask !== this.noMask) gl.deleteTexture(entry.mask);
      this.images.delete(other);
    }
    return this.images.get(index);
  }

  /** Shades an image into the texture of a side. */
  shaded(side, image, reference, look) {
    const { gl, framebuffer } = this;
    const { width, height } = image;
    const own = this.sides[side];
    if (own.width !== width || own.height !== height) {
      gl.deleteTexture(own.texture ?? null);
      const texture = this.upload(gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, null);
      this.sides[side] = { width, height, texture };
    }
    const { texture } = this.sides[side];
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    const { palette } = this;
    const textures = { image: image.texture, reference: reference.texture, mask: reference.mask, palette };
    const colors = errorColors(model.images[reference.index].light_mean);
    drawOver(gl, this.viewer, { framebuffer, width, height }, textures, { ...look, ...colors });
    return texture;
  }

  /** Draws; the reference is right of `split`, a share of the width. `look` has mode, tone, exposure, contrast. */
  draw(image, reference, { origin, scale }, split, isClipped, look) {
    const { gl, canvas } = this;
    const left_image = this.shaded(0, image, reference, look);
    const right_image = split === null ? left_image : this.shaded(1, reference, reference, look);
    drawOver(gl, this.place, canvas, { left_image, right_image }, {
      canvas_size: [canvas.width, canvas.height],
      split: split === null ? 1e9 : split * canvas.width,
      background: BACKGROUND[isDark.matches ? "dark" : "light"],
      shows_clipped: isClipped,
      ...{ origin, scale },
    }); // prettier-ignore
  }
}
