// The WebGL2 side of the comparison: images as half-float textures, shaded once a setting, and placed on the canvas.

import { mask, model, pictureAt, pixels } from "report/data";
import { drawOver, errorColors, keepContext, makePalette, makeProgram, makeTexture } from "report/program";

/** Images kept as textures; older scenes are freed. */
const TEXTURE_MAX = 96;
/** Uploads bind to this unit, so that they do not change the units used for drawing. */
const UPLOAD_UNIT = 7;
/** How pictures of what images are made of show values, in the order of the shader's numbers. */
const ENCODINGS = ["radiance", "color", "linear"];
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
    this.intermediate = makeProgram(gl, "intermediate");
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

  /** The texture of a side, in the size of an image, bound to be drawn into. */
  target(side, { width, height }) {
    const { gl, framebuffer } = this;
    const own = this.sides[side];
    if (own.width !== width || own.height !== height) {
      gl.deleteTexture(own.texture ?? null);
      const texture = this.upload(gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, null);
      this.sides[side] = { width, height, texture };
    }
    const { texture } = this.sides[side];
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return { framebuffer, width, height, texture };
  }

  /** Shades an image into the texture of a side. */
  shaded(side, image, reference, look) {
    const { gl, palette } = this;
    const target = this.target(side, image);
    const textures = { image: image.texture, reference: reference.texture, mask: reference.mask, palette };
    const colors = errorColors(model.images[reference.index].light_mean);
    drawOver(gl, this.viewer, target, textures, { ...look, ...colors });
    return target.texture;
  }

  /** Draws a picture of what an image is made of. */
  drawIntermediate(picture, place, isClipped, look) {
    const target = this.target(0, picture);
    const { encoding } = pictureAt(picture.index);
    const extents = encoding.linear ?? [0, 1, 2].map(() => ({ min: 0, max: 1 }));
    drawOver(this.gl, this.intermediate, target, { image: picture.texture, mask: picture.mask }, {
      encoding: ENCODINGS.indexOf(encoding.linear ? "linear" : encoding),
      low: extents.map(({ min }) => min),
      high: extents.map(({ max }) => max),
      ...{ ...look, off_mask_color: errorColors(1).off_mask_color },
    }); // prettier-ignore
    this.onCanvas(target.texture, target.texture, place, null, isClipped);
  }

  /** Draws; the reference is right of `split`, a share of the width. `look` has mode, tone, exposure, contrast. */
  draw(image, reference, place, split, isClipped, look) {
    const left_image = this.shaded(0, image, reference, look);
    const right_image = split === null ? left_image : this.shaded(1, reference, reference, look);
    this.onCanvas(left_image, right_image, place, split, isClipped);
  }

  /** Places shaded textures on the canvas. */
  onCanvas(left_image, right_image, { origin, scale }, split, isClipped) {
    const { gl, canvas } = this;
    drawOver(gl, this.place, canvas, { left_image, right_image }, {
      canvas_size: [canvas.width, canvas.height],
      split: split === null ? 1e9 : split * canvas.width,
      background: BACKGROUND[isDark.matches ? "dark" : "light"],
      shows_clipped: isClipped,
      ...{ origin, scale },
    }); // prettier-ignore
  }
}
