// The run's data as the page holds it: the model and the linear images.

import { byId } from "report/dom";

/**
 * @typedef {{ name: string, role: "fixed" | "scene" | "variant" | "display", values: string[], labels: string[],
 *   words: string[] }} Axis  An axis; labels and words are short texts of the values, words say what they are.
 * @typedef {{ run: number, cell: string, image: number | null, reference: number | null, verdict: string,
 *   intermediates: number | null, floor: number | null, axes: Record<string, string>,
 *   scores: Record<string, number | null>, scene?: Scene,
 *   original?: Row }} Row
 * @typedef {{ key: string, variants: Row[], main: Row }} Scene
 */

const json = (id) => JSON.parse(byId(id).textContent);
export const model = json("model");
let shaders = null;
/** The text of one of the page's shaders. */
export const shaderText = (name) => (shaders ??= json("shaders"))[name];
let light = null;
/** The tables of the live view, at the end of the page; read when needed. */
export const lightTables = () => (light ??= json("light"));
/** The name of the metric of the page's errors. */
export const headline = model.headline;
/** @type {Record<string, Axis>} */
export const axisOf = Object.fromEntries(model.axes.map((axis) => [axis.name, axis]));
const named = (role) => model.axes.filter((axis) => axis.role === role).map((axis) => axis.name);
export const sceneAxes = named("scene");
export const variantAxes = named("variant");

const textOf = (kind) => (axis, value) => {
  const place = axisOf[axis]?.values.indexOf(value) ?? -1;
  return place < 0 ? value : axisOf[axis][kind][place];
};
/** A value for readers: builtins without prefix, files without folder and extension, numbers rounded. */
export const short = textOf("labels");
/** The same with its unit or name: "5 lv", "alpha 0.25 (roughness 0.5)". */
export const word = textOf("words");
/** The name of an axis for readers. */
export const symbol = (name) => name.replaceAll("_", " ");

/** JSON has no infinity, so its name is written. */
const real = (field) => ({ inf: Infinity, "-inf": -Infinity, nan: NaN })[field] ?? field;

const placeOf = Object.fromEntries(model.columns.map((name, i) => [name, i]));

/** @returns {Row} */
function rowFrom(fields) {
  const at = (name) => (name in placeOf ? fields[placeOf[name]] : 0);
  const value = ({ name, values }) => (name === "run" ? model.runs[at("run")].label : (values[at(name)] ?? ""));
  const [run, cell, image, reference, verdict] = ["run", "cell", "image", "reference", "verdict"].map(at);
  return {
    ...{ run, cell, image, reference, verdict, intermediates: at("intermediates"), floor: real(at("noise_floor")) },
    axes: Object.fromEntries(model.axes.map((axis) => [axis.name, value(axis)])),
    scores: Object.fromEntries(model.metrics.map(({ name }) => [name, real(at(name))])),
  };
}

/** Every cell. @type {Row[]} */
export const rows = model.rows.map(rowFrom);
export const rowOf = (cell, run = 0) => rows.find((row) => row.cell === cell && row.run === Number(run));

/** Name of a cell among all runs: two runs of one plan have the same cells. */
export const idOf = (row) => (row.run ? `${row.cell}@${row.run}` : row.cell);

const methods = (axisOf.method?.values ?? []).filter(Boolean);
/** Label of the reference; a method may have the same name. */
export const truthName = methods.includes("reference") ? "Reference (truth)" : "Reference";

/** Who made an image: "Sampling, 16 samples", "Split sum (textbook)"; unknown axes are omitted. */
function maker(axes, names) {
  const said = (name) => (names.includes(name) && axes[name] ? word(name, axes[name]) : "");
  const diffuse = said("diffuse");
  if (axes.method === "none") return diffuse && diffuse !== "none" ? `${diffuse} only` : "No specular term";
  const samples = names.includes("samples") && axes.samples;
  const count = samples ? `${samples} sample${samples === "1" ? "" : "s"}` : "";
  return [[said("method"), count].filter(Boolean).join(", "), diffuse].filter(Boolean).join(" · ");
}

/** How a cell is made, without what all cells share: "Sampling, 16 samples", "Split sum (textbook) · 5 lv · 256 spp". */
export function variantLabel(row, without = []) {
  const all = variantAxes.length ? variantAxes : ["method", "samples"];
  const names = all.filter((name) => !without.includes(name));
  const others = names.filter((name) => !["method", "samples", "diffuse"].includes(name) && row.axes[name]);
  const parts = others.map((name) => word(name, row.axes[name]));
  // The run comes first: it tells images of two runs apart.
  const run = others.includes("run") ? parts.splice(others.indexOf("run"), 1) : [];
  return [...run, maker(row.axes, names), ...parts].filter(Boolean).join(" · ");
}
/** The same in code names: "sampled 16". */
export const variantCode = ({ axes }) => `${axes.method ?? ""} ${axes.samples ?? ""}`.trim();
/** The class of a method's colour. */
export const inkOf = ({ axes }) =>
  `is-${model.roles[axes.method] ?? (axes.samples ? "sampling" : axes.method?.startsWith("file:") ? "corrected" : "reference")}`;
/** What a cell shows, without what all pictures share: "sky · alpha 0.25 (roughness 0.5)". */
export const sceneLabel = (row) =>
  sceneAxes
    .filter((name) => scenes.some((scene) => scene.main.axes[name] !== row.axes[name]))
    .map((name) => word(name, row.axes[name]))
    .filter(Boolean)
    .join(" · ") || model.runs[row.run].name;
/** How visible the error of an image is. */
const visible = ({ scores }) => scores.flip ?? scores[headline] ?? -1;

/** How far the tone curve of a row is from the plain one. */
const distance = ({ axes }) =>
  Math.abs(Math.log(Number(axes.exposure) || 1)) + Math.abs(Math.log(Number(axes.contrast) || 1));
const grouped = (all, names) => Map.groupBy(all, (row) => JSON.stringify(names.map((name) => row.axes[name])));

/** Cells with the same scene values; of the tone curves of one image the plainest stays. */
const allScenes = [...grouped(rows, sceneAxes)].map(([key, own]) => {
  const variants = [...grouped(own, variantAxes).values()].map((copies) => {
    const plain = copies.reduce((best, row) => (distance(row) < distance(best) ? row : best));
    copies.forEach((row) => Object.assign(row, { original: plain }));
    return plain;
  });
  // A cell without some term has a reference without it; the scene's is the one that most of its cells have.
  const uses = (row) => variants.filter((other) => other.reference === row.reference).length;
  const main = variants.reduce((best, row) => (uses(row) > uses(best) ? row : best));
  const scene = { key, variants, main };
  own.forEach((row) => Object.assign(row, { scene }));
  return scene;
});
/** The scenes that are pictures. @type {Scene[]} */
export const scenes = allScenes.filter((scene) => !model.designs.includes(scene.main.axes.scene));

/** Whether the page holds the pixels of a cell's image. */
export const hasPixels = (row) => row.image !== null && model.images[row.image].payload !== null;

/** The pictures of what images are made of, numbered after the images. */
const intermediates = model.intermediates.pictures.map((one, i) => ({ ...one, index: model.images.length + i }));
/** The pictures of what a cell's image is made of: {name, index, encoding}. */
export const intermediatesOf = (row) =>
  (model.intermediates.sets[row.intermediates] ?? []).map((i) => intermediates[i]);
export const intermediateNotes = model.intermediates.notes;
/** An image, or a picture of what images are made of, by index. */
export const pictureAt = (index) => model.images[index] ?? intermediates[index - model.images.length];

/** The image that the views open with: of the textbook's split sum, else of a method without samples, the worst to see. */
export function firstRow(isWanted = hasPixels) {
  const shown = scenes.flatMap((scene) => scene.variants).filter(isWanted);
  const wanted = [(row) => inkOf(row) === "is-textbook", (row) => !row.axes.samples, () => true];
  const own = wanted.map((is) => shown.filter(is)).find((rows) => rows.length);
  return own?.reduce((worst, row) => (visible(row) > visible(worst) ? row : worst)) ?? rows[0];
}

/** Half-float bits to numbers. */
export const HALF = Float32Array.from({ length: 65536 }, (_, bits) => {
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  const special = fraction ? NaN : Infinity;
  const normal = exponent < 31 ? (1 + fraction / 1024) * 2 ** (exponent - 15) : special;
  return (bits & 0x8000 ? -1 : 1) * (exponent ? normal : fraction * 2 ** -24);
});

const payloadText = (index) => byId(`pixels-${index}`).textContent;

async function inflate(text) {
  const stream = new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))])
    .stream()
    .pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Sums differences modulo 256 over data[start, start + count). */
function undo(data, start = 0, count = data.length) {
  for (let i = start + 1; i < start + count; i++) data[i] = (data[i] + data[i - 1]) & 255;
  return data;
}

/** A packed image as half-float RGBA: {width, height, rgba}; of one channel it is grey. */
export async function decode(text, width, height) {
  const data = await inflate(text);
  const count = width * height;
  const rgba = new Uint16Array(4 * count).fill(0x3c00);
  const channels = data.length / count / 2;
  for (let channel = 0; channel < channels; channel++) {
    const high = 2 * channel * count;
    const low = high + count;
    undo(data, high, count);
    undo(data, low, count);
    for (let i = 0; i < count; i++) rgba[4 * i + channel] = (data[high + i] << 8) | data[low + i];
  }
  if (channels === 1) for (let i = 0; i < count; i++) rgba.fill(rgba[4 * i], 4 * i + 1, 4 * i + 3);
  return { width, height, rgba };
}

/** Decoded images and masks: the page's budget bounds them. */
const cache = new Map();
const once = (key, load) => cache.get(key) ?? cache.set(key, load()).get(key);

/** The embedded texels of an image as half-float RGBA: a promise of {width, height, rgba}, or of null. */
export function pixels(index) {
  const image = index === null ? null : pictureAt(index);
  if (!image || image.payload === null) return Promise.resolve(null);
  return once(`image ${index}`, () => decode(payloadText(image.payload), ...image.size));
}

/** The mask of a reference, or of a picture: bytes, 1 where pixels count. */
export function mask(index) {
  const image = index === null ? null : pictureAt(index);
  if (!image || image.mask === null) return Promise.resolve(null);
  return once(`mask ${image.mask}`, () => inflate(payloadText(image.mask)).then((data) => undo(data)));
}

/** Path of the complete EXR of an image; null in a page without the folder of its run. */
export const exrLink = (index) => {
  const image = model.images[index];
  const { link } = model.runs[image.run];
  return link && `${link}/images/${encodeURIComponent(image.file)}`;
};

const EPSILON_SHARE = 1e-2;
/** Relative and signed error of one texel under light of a mean luminance, by the formulas of the metrics. */
export function texelError(t, r, mean) {
  let [squares, sum] = [0, 0];
  for (let c = 0; c < 3; c++) {
    const d = t[c] - r[c];
    const scale = r[c] * r[c] + EPSILON_SHARE * mean * mean;
    squares += (d * d) / scale;
    sum += d / Math.sqrt(scale);
  }
  return { relative: Math.sqrt(squares / 3), signed: sum / 3 };
}

/** The colours and ticks of the map of an error, and the position of a value on it, 0 to 1. */
export function errorMap(isSigned) {
  const { magma, blue_red, relative, signed, relative_ticks, signed_ticks } = model.colors;
  if (isSigned) {
    const place = (value) => (value - signed[0]) / (signed[1] - signed[0]);
    return { colors: blue_red, ticks: signed_ticks, place };
  }
  const place = (value) => Math.log(Math.max(value, relative[0]) / relative[0]) / Math.log(relative[1] / relative[0]);
  return { colors: magma, ticks: relative_ticks, place };
}

/** Colour of a relative or signed error; the page's CPU twin of the shader's. */
export function errorColor(isSigned, error) {
  const { colors, place } = errorMap(isSigned);
  const value = isSigned ? error.signed : error.relative;
  return Number.isNaN(value) ? model.colors.nan : colors[Math.round(255 * Math.min(1, Math.max(0, place(value))))];
}

/** Display value in [0, 1] of linear radiance. */
export function tone(radiance, { exposure, contrast }) {
  const x = exposure * Math.max(0, radiance);
  return x === Infinity ? 1 : (x / (x + 1)) ** (contrast / 2.2);
}
