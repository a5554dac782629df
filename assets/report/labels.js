// Words within a drawing: how wide they are, and places where they cover nothing.

const pen = document.createElement("canvas").getContext("2d");
/** The height of a line of letters. */
const LINE = 13;

/** The width of a text of a chart, in its units. */
export function textWidth(text, size = 12, weight = 400) {
  pen.font = `${weight} ${size}px system-ui, "Segoe UI", "Helvetica Neue", "Noto Sans", Arial, sans-serif`;
  return pen.measureText(text).width;
}

/** What it costs to cover a thing: other words most, the mere run of a curve least. */
const COST = { word: 40, rule: 12, mark: 8, line: 1, outside: 400 };
/** Curves are looked at in steps of so many pixels. */
const STEP = 5;

/** What a drawing holds already. `frame`: {left, right, top, bottom}, within which words stay. */
export class Crowd {
  constructor(frame) {
    this.frame = frame;
    this.things = [];
  }

  add(kind, left, right, top, bottom) {
    this.things.push({ cost: COST[kind], left, right, top, bottom });
  }

  mark(x, y, r) {
    this.add("mark", x - r, x + r, y - r, y + r);
  }

  /** A straight line; a rule is one that a reader looks for. */
  line([x0, y0], [x1, y1], kind = "line") {
    if (kind === "rule") return this.add("rule", Math.min(x0, x1), Math.max(x0, x1), Math.min(y0, y1) - 1.5, Math.max(y0, y1) + 1.5);
    const steps = Math.min(400, Math.ceil(Math.hypot(x1 - x0, y1 - y0) / STEP));
    for (let i = 0; i <= steps; i++) { const x = x0 + ((x1 - x0) * i) / (steps || 1), y = y0 + ((y1 - y0) * i) / (steps || 1); this.add(kind, x - 1, x + 1, y - 1, y + 1); }
  }

  /**
   * The place of `candidates` ({x, y: the baseline, anchor, cost: how much less it is wanted}) at which a text covers least; the first of equals.
   * The text is part of the crowd from then on.
   */
  place(text, candidates) {
    const width = textWidth(text, 11.5), { frame } = this;
    const boxOf = ({ x, y, anchor }) => { const left = x - (anchor === "end" ? width : anchor === "middle" ? width / 2 : 0); return { left, right: left + width, top: y - LINE + 3, bottom: y + 2 }; };
    let best = null;
    for (const candidate of candidates) {
      const box = boxOf(candidate), isOut = box.left < frame.left || box.right > frame.right || box.top < frame.top || box.bottom > frame.bottom;
      let cost = (candidate.cost ?? 0) + (isOut ? COST.outside : 0);
      for (const thing of this.things) if (thing.left < box.right && thing.right > box.left && thing.top < box.bottom && thing.bottom > box.top) cost += thing.cost;
      if (!best || cost < best.cost) best = { cost, candidate, box };
    }
    this.add("word", best.box.left, best.box.right, best.box.top, best.box.bottom);
    return best.candidate;
  }
}

/** Places along a horizontal rule at `y`, above and below it. `wanted`: {isLeft, below}. */
export function alongRule(box, y, { isLeft, below }) {
  const sides = [isLeft ? 0 : 1, isLeft ? 1 : 0, ...Array.from({ length: 13 }, (_, i) => (i + 3) / 18)], heights = below ? [y + 14, y - 5] : [y - 5, y + 14];
  return sides.flatMap((at, i) => heights.map((place, j) => ({ x: box.left + 4 + at * (box.right - box.left - 8), y: place, anchor: at === 0 ? "start" : at === 1 ? "end" : "middle", cost: i + j })));
}

/** Places around a mark, the wanted one first. */
export function aroundMark(x, y, dx, dy) {
  const sides = [[dx, dy, "start"], [dx, 14, "start"], [-dx, dy, "end"], [-dx, 14, "end"], [0, -12, "middle"], [0, 20, "middle"], [dx, -20, "start"], [-dx, -20, "end"], [0, -26, "middle"], [0, 34, "middle"], [dx, 28, "start"], [-dx, 28, "end"]];
  return sides.map(([right, down, anchor], i) => ({ x: x + right, y: y + down, anchor, cost: i }));
}

/** Places beside a mark, as near to its height as there is room. */
export function besideMark(x, y, dx) {
  const steps = Array.from({ length: 41 }, (_, i) => (i % 2 ? 1 : -1) * Math.ceil(i / 2) * 3);
  return steps.map((down) => ({ x: x + dx, y: y + 4 + down, anchor: dx < 0 ? "end" : "start", cost: Math.abs(down) / 3 }));
}
