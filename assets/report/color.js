// Colours of quantities: the heat ramp between its stops, and the ink that can be read on it.

const STOPS = 7;
const channels = (text) =>
  text
    .trim()
    .match(/[0-9a-f]{2}/gi)
    .map((code) => parseInt(code, 16));
const stop = (i) => channels(getComputedStyle(document.documentElement).getPropertyValue(`--heat-${i}`));

/** Relative luminance of an sRGB colour (WCAG 2). */
function luminance(color) {
  const [r, g, b] = color.map((code) =>
    code <= 10.31475 ? code / 255 / 12.92 : ((code / 255 + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** Black or white, whichever stands out more: at least 4.58 to 1. */
export const inkOn = (color) => (luminance(color) > 0.179 ? "#000" : "#fff");

/** Fill and ink at `place` in [0, 1] of the heat ramp of the theme that is shown: {color, ink}. */
export function heat(place) {
  const at = Math.min(1, Math.max(0, place)) * (STOPS - 1),
    below = Math.min(STOPS - 2, Math.floor(at));
  const [a, b] = [stop(below), stop(below + 1)];
  const color = a.map((code, c) => Math.round(code + (at - below) * (b[c] - code)));
  return { color: `rgb(${color})`, ink: inkOn(color) };
}
