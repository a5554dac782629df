// The WebGL2 side of the comparison: the program, the images as half-float textures, one drawing.

import { mask, model, pixels } from "report/data";
import { makeProgram, paletteTexels, setErrorColors } from "report/program";

/** Images kept as textures; older scenes are freed. */
const TEXTURE_MAX = 96;
/** Texture units in the order of the shader's samplers. */
const UNITS = ["left_image", "right_image", "left_reference", "right_reference", "mask", "palette"];
/** Uploads bind here, so that they leave the units of the drawing alone. */
const UPLOAD_UNIT = UNITS.length;
const BACKGROUND = { light: [0.93, 0.93, 0.925], dark: [0.06, 0.063, 0.07] };

export class Surface {
  /** `onrestored` is called when a lost context is back and everything is to be drawn again. */
  constructor(canvas, onrestored) {
    this.canvas = canvas;
    /** Image index to {width, height, rgba, texture, mask, maskBytes}. */
    this.images = new Map();
    /** Images that are not to be freed. */
    this.wanted = new Set();
    this.gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!this.gl) return;
    this.setUp();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.images.clear();
      this.setUp();
      onrestored();
    });
  }

  setUp() {
    const { gl } = this;
    const { program, uniform } = makeProgram(gl, "viewer");
    gl.useProgram(program);
    this.uniform = uniform;
    UNITS.forEach((name, unit) => gl.uniform1i(this.uniform[name], unit));
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    this.palette = this.texture(gl.RGBA8, 256, 2, gl.RGBA, gl.UNSIGNED_BYTE, paletteTexels(model.colors));
    this.noMask = this.texture(gl.R8, 1, 1, gl.RED, gl.UNSIGNED_BYTE, Uint8Array.of(255));
    setErrorColors(gl, uniform, model.colors);
  }

  texture(internal, width, height, format, type, data) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + UPLOAD_UNIT);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, data);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Decodes and uploads an image once; a promise of its entry, null when no pixels are embedded. */
  async load(index) {
    if (this.images.has(index)) return this.images.get(index);
    const { gl } = this, [image, bytes] = await Promise.all([pixels(index), mask(index)]);
    if (!image) return null;
    // Another call may have been faster.
    if (this.images.has(index)) return this.images.get(index);
    const entry = { ...image, maskBytes: bytes, mask: this.noMask, texture: this.texture(gl.RGBA16F, image.width, image.height, gl.RGBA, gl.HALF_FLOAT, image.rgba) };
    if (bytes) entry.mask = this.texture(gl.R8, image.width, image.height, gl.RED, gl.UNSIGNED_BYTE, bytes.map((b) => b * 255));
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

  /** Draws at once. `split` is a share of the width, or null. */
  draw({ left, right, reference, rightReference, origin, scale, split, mode, tone, exposure, contrast, clipped }) {
    const { gl, canvas, uniform } = this;
    [left.texture, right.texture, reference.texture, rightReference.texture, reference.mask, this.palette].forEach((texture, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.uniform2f(uniform.canvas_size, canvas.width, canvas.height);
    gl.uniform2fv(uniform.origin, origin);
    gl.uniform1f(uniform.scale, scale);
    gl.uniform1f(uniform.split, split === null ? 1e9 : split * canvas.width);
    gl.uniform1i(uniform.mode, mode);
    gl.uniform1i(uniform.tone, tone);
    gl.uniform1f(uniform.exposure, exposure);
    gl.uniform1f(uniform.contrast, contrast);
    gl.uniform1i(uniform.shows_clipped, clipped ? 1 : 0);
    gl.uniform3fv(uniform.background, BACKGROUND[matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"]);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
