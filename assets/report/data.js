// The run's data as the page holds it: the model, the CSV tables and the linear images.

import { byId, unguarded } from "report/dom";

const json = (id) => JSON.parse(byId(id).textContent);
export const model = json("model");
let shaders = null;
/** The text of one of the page's shaders. */
export const shaderText = (name) => (shaders ??= json("shaders"))[name];
let light = null;
/** The tables of the live view. They stand last in the page and are read when they are needed. */
export const lightTables = () => (light ??= json("light"));
export const headline = model.headline;
export const axisOf = Object.fromEntries(model.axes.map((axis) => [axis.name, axis]));
const named = (role) => model.axes.filter((axis) => axis.role === role).map((axis) => axis.name);
export const sceneAxes = named("scene"), variantAxes = named("variant"), displayAxes = named("display");

/** The rows of a CSV text (RFC 4180), header first. */
export function parseCsv(text) {
  const rows = [];
  let row = [], field = "", quoted = false;
  for (let i = 0; i < text.length; i++) {
    const c = text[i];
    if (quoted) {
      if (c !== '"') field += c;
      else if (text[i + 1] === '"') { field += '"'; i++; }
      else quoted = false;
    } else if (c === '"') quoted = true;
    else if (c === ",") { row.push(field); field = ""; }
    else if (c === "\n") { row.push(field.replace(/\r$/, "")); rows.push(row); row = []; field = ""; }
    else field += c;
  }
  if (field || row.length) { row.push(field); rows.push(row); }
  return rows;
}

const tables = new Map();
/** A table of a run: {columns, rows, text}, or null when the run has none. */
export function table(run, name) {
  const id = `csv-${run}-${name}`;
  if (!tables.has(id)) {
    const text = byId(id) ? json(id) : null;
    const [columns, ...rows] = text === null ? [[]] : parseCsv(text).map((row) => row.map(unguarded));
    tables.set(id, text === null ? null : { columns, rows, text });
  }
  return tables.get(id);
}

/** Numbers of an axis as people read them: the fewest digits, but at least four, that tell them all apart. */
const roundings = new Map();
function rounded(axis, value) {
  if (!roundings.has(axis)) {
    const values = [...new Set(axisOf[axis]?.values ?? [])].filter((text) => text !== "" && Number.isFinite(Number(text)));
    const short = (digits) => new Map(values.map((text) => [text, Number(Number(text).toPrecision(digits)).toString()]));
    let digits = 4;
    while (digits < 17 && new Set(short(digits).values()).size < new Set(values.map(Number)).size) digits++;
    roundings.set(axis, short(digits));
  }
  return roundings.get(axis).get(value) ?? value;
}

/** A value as people say it: builtins without prefix, files without folder and extension, numbers rounded. */
export function short(axis, value) {
  if (axis !== "environment" && axis !== "scene") return rounded(axis, value);
  return value.startsWith("builtin:") ? value.slice(8) : value.replace(/^[^]*[/\\]/, "").replace(/\.[^.]*$/, "") || value;
}

/** The name of a number, where its axis has names for some, as for the level biases of engines. */
export const preset = (axis, value) => model.presets[axis]?.[value];

const extra = new Map(model.cells.map((cell) => [`${cell.run} ${cell.cell}`, cell]));

/** Every cell: {run, cell, axes, scores, floor, verdict, image, reference, time}. */
export const rows = model.runs.flatMap((run, index) => {
  const { columns, rows } = table(index, "errors.csv");
  const place = Object.fromEntries(columns.map((name, i) => [name, i]));
  const metrics = model.metrics.filter((metric) => metric.name in place);
  const real = (text) => text === "" || text === undefined ? null : text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text);
  return rows.map((fields) => {
    const cell = fields[place.cell];
    const { image = null, reference = null, frame_ms: time = null } = extra.get(`${index} ${cell}`) ?? {};
    return {
      run: index, cell, image, reference, time,
      axes: Object.fromEntries(model.axes.map(({ name }) => [name, name === "run" ? run.label : fields[place[name]] ?? ""])),
      scores: Object.fromEntries(metrics.map(({ name }) => [name, real(fields[place[name]])])),
      floor: real(fields[place[`${headline}_noise_floor`]]),
      verdict: fields[place.verdict],
    };
  });
});
export const rowOf = (cell, run = 0) => rows.find((row) => row.cell === cell && row.run === Number(run));

/** What names a cell among all runs: two runs of one plan have the same cells. */
export const idOf = (row) => (row.run ? `${row.cell}@${row.run}` : row.cell);

/** A value in words; a bare number says what it is. */
const word = (name, value) => {
  const text = short(name, value);
  if (text === "") return "";
  if (name === "irradiance_size") return text;
  if (name === "irradiance_sample_count") return `${text} samples`;
  return /^[−-]?[\d.]/.test(text) && !["method", "samples", "run"].includes(name) ? `${symbol(name)} ${text}` : text;
};
const methods = (axisOf.method?.values ?? []).filter(Boolean);
/** What the images are held against; a way to make them may be called reference, too. */
export const truthName = methods.includes("reference") ? "reference (truth)" : "reference";
/** An image without a specular term is named by its diffuse one. */
function bareName(diffuse) {
  if (!diffuse || diffuse === "none") return "no specular term";
  return methods.length > 1 ? `${diffuse} only` : diffuse;
}
/** How a cell is made: "sampled 16", "sampled 16 bias 0.5 set 2", "irradiance-map 64x32, 128x32 samples"; axes may be left out. */
export function variantLabel(row, without = []) {
  const names = (variantAxes.length ? variantAxes : ["method", "samples"]).filter((name) => !without.includes(name)), { axes } = row;
  const isDrawn = axes.method === "reference" && axes.samples && names.includes("method") && names.includes("samples");
  const part = (name) => {
    if (name === "method" && axes.method === "none") return names.includes("diffuse") ? "" : bareName(axes.diffuse);
    if (name === "diffuse" && axes.method === "none") return bareName(axes.diffuse);
    if (isDrawn && name === "method") return "reference,";
    if (isDrawn && name === "samples") return `${axes.samples} samples`;
    if (name === "irradiance_size" && axes[name] && names.includes("irradiance_sample_count")) return `${axes[name]},`;
    return word(name, axes[name] ?? "");
  };
  return names.map(part).filter(Boolean).join(" ");
}
/** What a cell shows: "sky ggx α 0.25". */
export const sceneLabel = (row) => sceneAxes.map((name) => word(name, row.axes[name])).filter(Boolean).join(" · ") || model.runs[row.run].provenance.name;
/** The name of an axis as people say it. */
export function symbol(name) {
  return { alpha: "α", lod_bias: "bias", point_set: "set", environment_rotation_deg: "turned", environment_scale: "brightness" }[name] ?? name;
}

/**
 * Why the experiment has no cell with these values, by axis name; null when no exclusion says so. A value that is unset on either side
 * tells nothing apart.
 */
export function exclusionOf(wanted) {
  const { axes, points, reasons } = model.exclusions;
  const tests = axes.map((name) => wanted[name]);
  const found = points.find(([, values]) => values.every((value, i) => tests[i] === undefined || tests[i] === "" || value === "" || value === tests[i]));
  return found ? reasons[found[0]] : null;
}

/** Cells with the same scene values; tone-curve copies of one image are kept in `row.copies`. */
export const scenes = [];
{
  const byKey = new Map(), byImage = new Map();
  for (const row of rows) {
    const key = JSON.stringify(sceneAxes.map((name) => row.axes[name]));
    if (!byKey.has(key)) { byKey.set(key, { key, label: sceneLabel(row), variants: [] }); scenes.push(byKey.get(key)); }
    const scene = byKey.get(key), imageKey = JSON.stringify([key, ...variantAxes.map((name) => row.axes[name])]);
    row.scene = scene;
    if (!byImage.has(imageKey)) { byImage.set(imageKey, row); row.copies = []; scene.variants.push(row); }
    byImage.get(imageKey).copies.push(row);
    row.original = byImage.get(imageKey);
  }
}
/** How far the tone curve of a row is from the plain one. */
const distance = ({ axes }) => Math.abs(Math.log(Number(axes.exposure) || 1)) + Math.abs(Math.log(Number(axes.contrast) || 1));
for (const scene of scenes) {
  // Of the tone curves that were tried over an image the plainest stands for it.
  scene.variants = scene.variants.map(({ copies }) => {
    const plain = copies.reduce((best, row) => (distance(row) < distance(best) ? row : best));
    copies.forEach((row) => { row.original = plain; row.copies = []; });
    plain.copies = copies;
    return plain;
  });
  // A cell without some term has a reference without it; the scene's is the one that most of its cells have.
  const uses = (row) => scene.variants.filter((other) => other.reference === row.reference).length;
  scene.main = scene.variants.reduce((best, row) => (uses(row) > uses(best) ? row : best));
}
/** Labels of all variants, in the order of the rows. */
export const variantLabels = [...new Set(scenes.flatMap((scene) => scene.variants.map((row) => variantLabel(row))))];

/** Whether the page holds the pixels of a cell's image. */
export const hasPixels = (row) => row.image !== null && model.images[row.image].payload !== null;

/** Half-float bits to numbers. */
export const HALF = new Float32Array(65536);
for (let bits = 0; bits < 65536; bits++) {
  const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
  HALF[bits] = sign * (exponent === 0 ? fraction * 2 ** -24 : exponent === 31 ? (fraction ? NaN : Infinity) : (1 + fraction / 1024) * 2 ** (exponent - 15));
}

const payloadText = (index) => byId(`pixels-${index}`).textContent;

/** The bytes of base64 text. */
export const base64Bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

async function inflate(text) {
  const bytes = base64Bytes(text);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  const data = new Uint8Array(await new Response(stream).arrayBuffer());
  return data;
}

/** Sums differences modulo 256 over data[start, start + count). */
function undo(data, start, count) {
  for (let i = start + 1; i < start + count; i++) data[i] = (data[i] + data[i - 1]) & 255;
}

/** A packed image as half-float RGBA: {width, height, rgba}. */
export async function decode(text, width, height) {
  const data = await inflate(text), count = width * height;
  const rgba = new Uint16Array(4 * count);
  for (let channel = 0; channel < 3; channel++) {
    const high = 2 * channel * count, low = high + count;
    undo(data, high, count);
    undo(data, low, count);
    for (let i = 0; i < count; i++) rgba[4 * i + channel] = (data[high + i] << 8) | data[low + i];
  }
  for (let i = 0; i < count; i++) rgba[4 * i + 3] = 0x3c00;
  return { width, height, rgba };
}

/** Decoded images kept; old ones are dropped so that a large page does not fill the memory. */
const CACHE_TEXELS = 24e6;
const cache = new Map();
let cachedTexels = 0;

/** The embedded texels of an image as half-float RGBA: a promise of {width, height, rgba}, null when nothing is embedded. */
export function pixels(index) {
  const image = index === null ? null : model.images[index];
  if (!image || image.payload === null) return Promise.resolve(null);
  if (!cache.has(index)) {
    cache.set(index, decode(payloadText(image.payload), image.window.width, image.window.height));
    cachedTexels += image.window.width * image.window.height;
    for (const old of cache.keys()) {
      if (cachedTexels <= CACHE_TEXELS || old === index) break;
      cachedTexels -= model.images[old].window.width * model.images[old].window.height;
      cache.delete(old);
    }
  }
  const promise = cache.get(index);
  cache.delete(index);
  cache.set(index, promise);
  return promise;
}

/** The whole image, reduced where only a window of it is embedded. */
export function overview(index) {
  const image = index === null ? null : model.images[index];
  return image?.overview ? decode(payloadText(image.overview[1]), ...image.overview[0]) : pixels(index);
}

const masks = new Map();
/** The mask of a reference's window: bytes, 1 where pixels count. */
export function mask(reference) {
  const image = reference === null ? null : model.images[reference];
  if (!image || image.mask === null) return Promise.resolve(null);
  if (!masks.has(image.mask)) {
    masks.set(image.mask, inflate(payloadText(image.mask)).then((data) => { undo(data, 0, data.length); return data; }));
  }
  return masks.get(image.mask);
}

/** Where the full EXR of an image lies. */
export const exrLink = (index) => {
  const image = model.images[index];
  return `${model.runs[image.run].link}/images/${encodeURIComponent(image.file)}`;
};

const EPSILON = 1e-2;
/** Relative and signed error of one texel, by the formulas of the metrics. */
export function texelError(t, r) {
  let squares = 0, sum = 0;
  for (let c = 0; c < 3; c++) {
    const d = t[c] - r[c], scale = r[c] * r[c] + EPSILON;
    squares += (d * d) / scale;
    sum += d / Math.sqrt(scale);
  }
  return { relative: Math.sqrt(squares / 3), signed: sum / 3 };
}

/** Colour of a relative or signed error; the page's CPU twin of the shader's. */
export function errorColor(mode, error) {
  const { magma, blue_red, relative, signed, nan } = model.colors;
  const value = mode === "signed" ? error.signed : error.relative;
  if (Number.isNaN(value)) return nan;
  const place = mode === "signed" ? (value - signed[0]) / (signed[1] - signed[0]) : Math.log(Math.max(value, relative[0]) / relative[0]) / Math.log(relative[1] / relative[0]);
  return (mode === "signed" ? blue_red : magma)[Math.round(255 * Math.min(1, Math.max(0, place)))];
}

/** Display value in [0, 1] of linear radiance. */
export function tone(radiance, { tone, exposure, contrast }) {
  const x = exposure * Math.max(0, radiance);
  if (tone !== "srgb") return x === Infinity ? 1 : (x / (x + 1)) ** (contrast / 2.2);
  const c = Math.min(1, x);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
}
