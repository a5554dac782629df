// What the pointer and the keys do in the comparison of images.

import { hasPixels, variantLabel } from "report/data";

const KEY_MAX = 9;
/** What the exposure reaches, stops. */
export const STOPS = [-14, 14];

/**
 * The images that the keys 1 to 9 show: those with pixels, of several point sets the first. Methods without samples always have a key: where
 * there are too many images, the largest sample counts go without.
 */
export function keyedVariants(scene) {
  const ways = new Map();
  for (const row of scene.variants.filter(hasPixels)) {
    const way = variantLabel(row, ["point_set"]);
    if (!ways.has(way)) ways.set(way, row);
  }
  const shown = [...ways.values()],
    fixed = shown.filter((row) => !row.axes.samples).slice(0, KEY_MAX);
  const sampled = shown.filter((row) => row.axes.samples).slice(0, KEY_MAX - fixed.length);
  return shown.filter((row) => fixed.includes(row) || sampled.includes(row));
}

/** Follows the pointer over the image and the split. */
export function listen(viewer) {
  const { canvas } = viewer,
    pointers = new Map();
  let moved = false,
    spread = 0,
    frame = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    moved = false;
    spread = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!viewer.row || !viewer.origin) return;
    const before = pointers.get(event.pointerId);
    if (before) {
      const ratio = canvas.width / canvas.getBoundingClientRect().width;
      pointers.set(event.pointerId, event);
      if (Math.hypot(event.clientX - before.clientX, event.clientY - before.clientY) > 0) moved ||= event.buttons > 0;
      if (pointers.size === 2) {
        const [a, b] = [...pointers.values()],
          distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        const box = canvas.getBoundingClientRect();
        if (spread && Math.abs(distance / spread - 1) > 0.08) {
          viewer.zoom(
            distance / spread,
            ((a.clientX + b.clientX) / 2 - box.left) * ratio,
            ((a.clientY + b.clientY) / 2 - box.top) * ratio,
          );
          spread = distance;
        }
        spread ||= distance;
      } else viewer.pan((event.clientX - before.clientX) * ratio, (event.clientY - before.clientY) * ratio);
      return;
    }
    if (viewer.pinned) return;
    viewer.probed = viewer.texelAt(event);
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(() => viewer.probe());
  });
  const up = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (moved) {
      if (viewer.row) viewer.keepState();
      return;
    }
    if (!viewer.row || !viewer.origin) return;
    viewer.pinned = !viewer.pinned || String(viewer.probed) !== String(viewer.texelAt(event));
    viewer.probed = viewer.texelAt(event);
    viewer.probe();
    viewer.keepState();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const box = canvas.getBoundingClientRect(),
        ratio = canvas.width / box.width;
      viewer.zoom(
        event.deltaY < 0 ? 1.2 : 1 / 1.2,
        (event.clientX - box.left) * ratio,
        (event.clientY - box.top) * ratio,
      );
    },
    { passive: false },
  );
  viewer.handle.addEventListener("pointerdown", (event) => viewer.handle.setPointerCapture(event.pointerId));
  viewer.handle.addEventListener("pointermove", (event) => {
    if (!viewer.handle.hasPointerCapture(event.pointerId)) return;
    const box = viewer.stage.getBoundingClientRect();
    viewer.split = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    viewer.draw();
  });
  viewer.handle.addEventListener("pointerup", () => viewer.keepState());
}

/** Handles a key of the comparison; true when it was one. */
export function key(viewer, event) {
  if (!viewer.row || !viewer.scene) return false;
  const onHandle = document.activeElement === viewer.handle;
  const actions = {
    " ": () => viewer.hold(true),
    e: () => {
      viewer.mode = viewer.mode === "error" ? "image" : "error";
      viewer.redraw();
    },
    s: () => {
      viewer.mode = viewer.mode === "signed" ? "image" : "signed";
      viewer.redraw();
    },
    t: () => {
      if (viewer.mode !== "image") return;
      viewer.tone = viewer.tone === "srgb" ? "curve" : "srgb";
      viewer.redraw();
    },
    c: () => {
      viewer.clipped = !viewer.clipped;
      viewer.redraw();
    },
    d: () => viewer.setSplit(viewer.split === null ? 0.5 : null),
    "[": () => {
      if (viewer.mode !== "image") return;
      viewer.stops = Math.max(STOPS[0], viewer.stops - 0.5);
      viewer.redraw();
    },
    "]": () => {
      if (viewer.mode !== "image") return;
      viewer.stops = Math.min(STOPS[1], viewer.stops + 0.5);
      viewer.redraw();
    },
    "+": () => viewer.zoom(1.5),
    "=": () => viewer.zoom(1.5),
    "-": () => viewer.zoom(1 / 1.5),
    0: () => {
      viewer.fit();
      viewer.draw();
      viewer.keepState();
    },
    ArrowLeft: () => (onHandle ? viewer.setSplit(Math.max(0, viewer.split - 0.02)) : viewer.step(-1)),
    ArrowRight: () => (onHandle ? viewer.setSplit(Math.min(1, viewer.split + 0.02)) : viewer.step(1)),
    ArrowUp: () => viewer.stepScene(-1),
    ArrowDown: () => viewer.stepScene(1),
  };
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (event.shiftKey && name in moves) {
    viewer.moveProbe(...moves[name]);
  } else if (/^[1-9]$/.test(name)) {
    const row = keyedVariants(viewer.scene)[Number(name) - 1];
    if (row) viewer.choose(row);
  } else if (name in actions) {
    if (!(name === " " && event.repeat)) actions[name]();
  } else return false;
  return true;
}
