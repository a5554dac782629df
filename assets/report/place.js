// Position of the comparison's image on its canvas.

import { clamp } from "report/stage";

const SCALE_MAX = 96;

export class Place {
  constructor(canvas) {
    this.canvas = canvas;
    /** Texel at the canvas' top left corner, null before an image is placed. */
    this.origin = null;
    /** Canvas pixels a texel. */
    this.scale = 1;
    /** Whether the image is as large as the canvas allows; else the reader has chosen a place. */
    this.isFitted = true;
  }

  /** Whole canvas pixels per texel if the image is smaller than the canvas, so that all texels are equally wide. */
  fit({ width, height }) {
    const scale = Math.min(this.canvas.width / width, this.canvas.height / height);
    this.scale = this.fitScale = scale >= 1 ? Math.floor(scale) : scale;
    this.isFitted = true;
    this.center([width / 2, height / 2]);
  }

  /** The scales that the reader can choose. */
  get range() {
    return [Math.min(this.fitScale, 1) / 2, SCALE_MAX];
  }

  center(middle) {
    const sides = [this.canvas.width, this.canvas.height];
    this.origin = middle.map((at, i) => at - sides[i] / 2 / this.scale);
    if (this.scale >= 1) this.origin = this.origin.map((at) => Math.round(at * this.scale) / this.scale);
  }

  get middle() {
    return [this.canvas.width, this.canvas.height].map((side, i) => this.origin[i] + side / 2 / this.scale);
  }

  /** Zooms by `factor` and leaves the texel under a canvas pixel where it is. */
  zoom(factor, pixel) {
    const texel = this.at(pixel);
    let scale = clamp(this.scale * factor, this.range[0], this.range[1]);
    if (scale > 1) scale = factor > 1 ? Math.ceil(scale - 1e-6) : Math.floor(scale + 1e-6);
    Object.assign(this, { scale, isFitted: false, origin: texel.map((at, i) => at - pixel[i] / scale) });
  }

  pan(by) {
    this.isFitted = false;
    this.origin = this.origin.map((at, i) => at - by[i] / this.scale);
  }

  /** Centres a texel that is out of sight. */
  reveal(texel) {
    const [x, y] = texel.map((at, i) => (at + 0.5 - this.origin[i]) * this.scale);
    if (x >= 0 && y >= 0 && x <= this.canvas.width && y <= this.canvas.height) return;
    this.isFitted = false;
    this.center(texel.map((at) => at + 0.5));
  }

  /** The place in the image under a canvas pixel. */
  at(pixel) {
    return pixel.map((side, i) => this.origin[i] + side / this.scale);
  }
}
