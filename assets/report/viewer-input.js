// The keys of the comparison.

import { hasPixels, variantLabel } from "report/data";
import { clamp } from "report/stage";

const KEY_MAX = 9;
/**
 * The images that the keys 1 to 9 show: those with pixels, of several point sets the first. Methods without samples
 * always have a key; with too many images, the largest sample counts get none.
 */
export function keyedVariants(scene) {
  const ways = new Map();
  for (const row of scene.variants.filter(hasPixels)) {
    const way = variantLabel(row, ["point_set"]);
    if (!ways.has(way)) ways.set(way, row);
  }
  const shown = [...ways.values()];
  const fixed = shown.filter((row) => !row.axes.samples).slice(0, KEY_MAX);
  const sampled = shown.filter((row) => row.axes.samples).slice(0, KEY_MAX - fixed.length);
  return shown.filter((row) => fixed.includes(row) || sampled.includes(row));
}

/** Handles a key; true if the comparison uses it. */
export function key(viewer, event) {
  if (!viewer.row || !viewer.scene) return false;
  const { mode, tone, isClipped, split } = viewer;
  const isImage = mode === "image";
  const stops = viewer.controls.range("stops");
  const show = (wanted) => viewer.set({ mode: mode === wanted ? "image" : wanted });
  const brighten = (by) => isImage && viewer.set({ stops: clamp(viewer.stops + by, stops[0], stops[1]) });
  const actions = {
    " ": () => viewer.hold(true),
    e: () => show("error"),
    s: () => show("signed"),
    t: () => isImage && viewer.set({ tone: tone === "srgb" ? "curve" : "srgb" }),
    c: () => viewer.set({ isClipped: !isClipped }),
    p: () => viewer.play(),
    n: () => viewer.stepIntermediate(),
    d: () => viewer.set({ split: split === null ? 0.5 : null }),
    "[": () => brighten(-0.5),
    "]": () => brighten(0.5),
    "+": () => viewer.zoom(1.5),
    "-": () => viewer.zoom(1 / 1.5),
    0: () => viewer.refit(),
    ...{ ArrowLeft: () => viewer.step(-1), ArrowRight: () => viewer.step(1) },
    ...{ ArrowUp: () => viewer.stepScene(-1), ArrowDown: () => viewer.stepScene(1) },
  };
  const name = event.key.length === 1 ? event.key.toLowerCase().replace("=", "+") : event.key;
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (event.shiftKey && name in moves) viewer.moveProbe(moves[name][0], moves[name][1]);
  else if (/^[1-9]$/.test(name)) {
    const row = keyedVariants(viewer.scene)[Number(name) - 1];
    if (row) viewer.choose(row);
  } else if (!(name in actions)) return false;
  else if (name !== " " || !event.repeat) actions[name]();
  return true;
}
