// Starts the page: navigation, the first screen, keys.

import { hasPixels, headline, model, scenes, variantLabel } from "report/data";
import { byId, h } from "report/dom";
import { settingsOf, showGrid, thumbnail } from "report/grid";
import { breakEvenChart, breakEvenMap, equalTimeMap } from "report/break-even";
import { pairs } from "report/cases";
import { convergence, hasConvergence, profile, showPlots } from "report/plots";
import { liveKey, liveRelease, showLive } from "report/live";
import { go, link, onState, state } from "report/state";
import { showRun, showTables } from "report/tables";
import { showViewer, viewerKey, viewerRelease } from "report/viewer";

const PAGES = [
  ["answer", "Answer", showAnswer], ["images", "Images", showGrid], ["compare", "Compare", showViewer], ["live", "Live", showLive],
  ["plots", "Plots", showPlots], ["tables", "Tables", showTables], ["run", "Run", showRun],
];

const KEYS = [
  ["1 … 9", "show an image of the scene"], ["space (hold)", "show the reference"], ["← →", "previous, next image"], ["↑ ↓", "previous, next scene"],
  ["E", "relative error"], ["S", "signed error"], ["T", "tone curve or sRGB"], ["[ ]", "half a stop darker, brighter"], ["C", "mark clipped pixels"],
  ["D", "split with the reference"], ["+ − 0", "zoom in, out, fit"], ["click", "pin the probe"], ["shift + arrows", "move the probe by a texel"], ["live: 1 … 4", "split sum, sampled, error, signed error"], ["live: arrows, drag", "turn; + − and the wheel come nearer, 0 returns"], ["live: space (hold)", "show the other of split sum and sampled"],
  ["G A I M L P B R", "go to Answer (G or A), Images, coMpare, Live, Plots, taBles, Run"], ["?", "this list"],
];
const GO = { a: "answer", g: "answer", i: "images", m: "compare", l: "live", p: "plots", b: "tables", r: "run" };

/** How far each page was scrolled when it was left: pages are like tabs. */
const places = new Map();

function show(current) {
  const known = PAGES.find(([name]) => name === current.view) ?? PAGES[0], before = document.body.dataset.view;
  const isNew = before !== known[0];
  if (isNew && before) places.set(before, scrollY);
  const hadFocus = before && byId(`view-${before}`).contains(document.activeElement);
  for (const [name] of PAGES) byId(`view-${name}`).hidden = name !== known[0];
  for (const item of byId("pages").children) item.toggleAttribute("aria-current", item.dataset.view === known[0]);
  const here = byId("pages").querySelector("[aria-current]");
  here.setAttribute("aria-current", "page");
  byId("pages").scrollLeft = here.offsetLeft - 60;
  document.body.dataset.view = known[0];
  known[2](byId(`view-${known[0]}`), current);
  if (!isNew) return;
  scrollTo(0, places.get(known[0]) ?? 0);
  // What had the focus is gone: the keyboard goes on at the new page's beginning.
  if (hadFocus) byId("main").focus({ preventScroll: true });
}

let answered = false;
/** Charts and a sample of the images below the sentence, which stands in the page already. */
function showAnswer() {
  if (answered) return;
  answered = true;
  const pair = pairs[0];
  if (pair) {
    byId("lead-chart").append(breakEvenChart(pair));
    byId("answer-rest").append(h("div", { class: "two" }, [breakEvenMap(pair), equalTimeMap(pair), strip(pair)].filter(Boolean)));
  } else {
    const lead = hasConvergence ? convergence() : scenes.length ? profile(scenes[0]) : null;
    if (lead) byId("lead-chart").append(lead);
    byId("answer-rest").append(strip(null));
  }
  if (model.differences.length) byId("answer-rest").append(h("p", { class: "note" }, "Joined runs differ in ", model.differences.map(([name]) => name).join(", "), ". ", h("a", { href: "#run" }, "Details")));
}

/** The images of one telling scene: the case in the middle. */
function strip(pair) {
  const withPixels = scenes.filter((scene) => scene.variants.some(hasPixels));
  if (!withPixels.length) return h("p", { class: "note" }, model.image_notes.join(" "));
  const cases = pair ? [...pair.cases].sort((a, b) => (a.crossing ?? Infinity) - (b.crossing ?? Infinity)) : [];
  const middle = cases[Math.floor((cases.length - 1) / 2)];
  const scene = withPixels.find((one) => middle && one.variants.some((row) => row.cell === middle.fixed_cell && row.run === middle.fixed_run)) ?? withPixels[0];
  const own = scene.variants, settings = settingsOf(scene.main);
  const fixed = middle && own.find((row) => row.cell === middle.fixed_cell);
  const sampled = own.filter((row) => (pair ? row.axes.method === pair.sampled : row.axes.method !== "none"));
  const at = sampled.find((row) => middle && Number(row.axes.samples) === middle.break_even.n) ?? sampled.at(-1);
  const ranked = [...sampled].sort((a, b) => a.scores[headline] - b.scores[headline]);
  const chosen = [...new Set((pair ? [fixed, sampled[0], at] : [ranked.at(-1), ranked[ranked.length >> 1], ranked[0]]).filter(Boolean))];
  return h("figure", { class: "figure strip" }, h("figcaption", {}, h("h3", {}, `See it: ${scene.label}`)),
    h("p", { class: "note" }, pair ? "The scene whose break-even lies in the middle. Above the images, below their relative error (magma, 10⁻³ to 1). Click to compare them pixel by pixel." : "The largest, the middle and the lowest error. Above the images, below their relative error (magma, 10⁻³ to 1)."),
    h("div", { class: "strip-images" }, h("div", {}, h("h4", {}, "reference"), thumbnail(scene.main, "image", settings, { isReference: true })),
      chosen.map((row) => h("div", {}, h("h4", {}, variantLabel(row)), thumbnail(row, "image", settings), thumbnail(row, "error", settings)))),
    h("p", {}, h("a", { href: "#images" }, `All ${scenes.length} scenes`), " · ", h("a", { href: link({ view: "compare", cell: (fixed ?? own[0]).cell, split: 0.5 }) }, "Compare with the reference")));
}

function help() {
  const dialog = byId("help");
  if (!dialog.firstChild) {
    dialog.append(h("h2", { id: "help-title" }, "Keys"), h("table", { class: "plain" }, h("tbody", {}, KEYS.map(([key, what]) => h("tr", {}, h("th", { scope: "row" }, h("kbd", {}, key)), h("td", {}, what))))),
      h("form", { method: "dialog" }, h("button", {}, "Close")));
  }
  dialog.showModal();
}

/** Whether keys belong to the element that has the focus. */
const isTyping = (element) => element?.matches("input:not([type=range]):not([type=checkbox]), select, textarea, [contenteditable]");

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target) || byId("help").open) return;
  const ownKey = { compare: viewerKey, live: liveKey }[document.body.dataset.view];
  // Space and arrows keep their meaning on buttons and sliders.
  const isOwn = event.target.matches("button, a, summary") && [" ", "Enter"].includes(event.key);
  const isSlider = event.target.matches("input[type=range]") && event.key.startsWith("Arrow");
  if (ownKey && !(isOwn && event.key === "Enter") && !isSlider && ownKey(event)) {
    event.preventDefault();
  } else if (event.key === "?") {
    help();
  } else if (GO[event.key] && !isOwn) {
    go({ view: GO[event.key] });
  }
}

/** The held key is up, or out of sight. */
function release() {
  viewerRelease();
  liveRelease();
}

/** Called once, by the page. */
export function start() {
  byId("pages").append(...PAGES.map(([name, title]) => h("a", { href: `#${name}`, "data-view": name }, title)));
  byId("tools").append(h("button", { type: "button", onclick: help, "aria-label": "Keys", title: "Keys (?)" }, "?"));
  addEventListener("keydown", onKey);
  addEventListener("keyup", (event) => { if (event.key === " ") release(); });
  addEventListener("blur", release);
  byId("skip").addEventListener("click", (event) => { event.preventDefault(); byId("main").focus(); });
  history.scrollRestoration = "manual";
  onState(show);
  const begin = () => { show(state()); document.body.dataset.ready = String(Math.round(performance.now())); };
  // The images stand after the script; they are needed only once the page is parsed.
  if (document.readyState === "loading") addEventListener("DOMContentLoaded", begin); else begin();
}
