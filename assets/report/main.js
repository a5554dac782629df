// Starts the page: navigation, the first screen, keys.

import { showAnswer } from "report/answer";
import { byId, h } from "report/dom";
import { showGrid } from "report/grid";
import { liveKey, liveRelease, showLive } from "report/live";
import { showPlots } from "report/plots";
import { showRun } from "report/run";
import { go, onState, state } from "report/state";
import { showTables } from "report/tables";
import { showViewer, viewerKey, viewerRelease } from "report/viewer";

const PAGES = [
  ["answer", "Answer", showAnswer], ["images", "Images", showGrid], ["compare", "Compare", showViewer], ["live", "Live", showLive],
  ["plots", "Plots", showPlots], ["tables", "Tables", showTables], ["run", "Run", showRun],
];

const KEYS = [
  ["1 … 9", "show an image of the scene"], ["space (hold)", "show the reference"], ["← →", "previous, next image"], ["↑ ↓", "previous, next scene"],
  ["E", "relative error"], ["S", "signed error"], ["T", "tone curve or sRGB"], ["[ ]", "half a stop darker, brighter"], ["C", "mark clipped pixels, or errors beyond the range of colours"],
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
  signalMore();
  document.body.dataset.view = known[0];
  known[2](byId(`view-${known[0]}`), current);
  if (!isNew) return;
  scrollTo(0, places.get(known[0]) ?? 0);
  // What had the focus is gone: the keyboard goes on at the new page's beginning.
  if (hadFocus) byId("main").focus({ preventScroll: true });
}

/** Fades the ends of the menu beyond which it goes on. */
function signalMore() {
  const { scrollLeft, scrollWidth, clientWidth, dataset } = byId("pages");
  dataset.more = [scrollLeft > 1 ? "left" : "", scrollLeft + clientWidth < scrollWidth - 1 ? "right" : ""].filter(Boolean).join(" ");
}

function help() {
  const dialog = byId("help");
  if (!dialog.firstChild) {
    dialog.append(h("h2", {}, "Keys"), h("table", { class: "plain" }, h("tbody", {}, KEYS.map(([key, what]) => h("tr", {}, h("th", { scope: "row" }, h("kbd", {}, key)), h("td", {}, what))))),
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
  } else if (Object.hasOwn(GO, event.key.toLowerCase()) && !isOwn) {
    go({ view: GO[event.key.toLowerCase()] });
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
  byId("pages").addEventListener("scroll", signalMore, { passive: true });
  addEventListener("resize", signalMore);
  // Colours of quantities are computed for the theme.
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { if (["answer", "plots"].includes(document.body.dataset.view)) show(state()); });
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
