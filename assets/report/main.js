// Starts the page: navigation between its views, keys.

import { startAnswer } from "report/answer";
import { byId, h } from "report/dom";
import { showGrid } from "report/grid";
import { liveKey, liveRelease, showLive } from "report/live";
import { go, onState, state } from "report/state";
import { showTables } from "report/tables";
import { showViewer, viewerKey, viewerRelease } from "report/viewer";

/** Views by name: title, key, function that fills it. The page already contains Answer and Run. */
const VIEWS = {
  answer: ["Answer", "a", () => {}],
  images: ["Images", "i", showGrid],
  compare: ["Compare", "m", showViewer],
  live: ["Live", "l", showLive],
  tables: ["Tables", "b", showTables],
  run: ["Run", "r", () => {}],
};
const GO = { g: "answer", ...Object.fromEntries(Object.entries(VIEWS).map(([name, [, key]]) => [key, name])) };

/** How far each view was scrolled when it was left: views are like tabs. */
const places = new Map();

/** Shows the view that the address names; an address of an answer shows the answers, at that one. */
function show(current) {
  const before = document.body.dataset.view;
  const name = Object.hasOwn(VIEWS, current.view) ? current.view : "answer";
  const anchor = current.view === name ? null : byId("view-answer").querySelector(`[id="${CSS.escape(current.view)}"]`);
  const isNew = before !== name;
  if (isNew && before) places.set(before, scrollY);
  const hadFocus = before && byId(`view-${before}`).contains(document.activeElement);
  for (const other of Object.keys(VIEWS)) byId(`view-${other}`).hidden = other !== name;
  for (const item of byId("pages").children) {
    if (item.getAttribute("data-view") === name) item.setAttribute("aria-current", "page");
    else item.removeAttribute("aria-current");
  }
  document.body.dataset.view = name;
  VIEWS[name][2](byId(`view-${name}`), current);
  if (anchor) anchor.scrollIntoView();
  if (!isNew) return;
  if (!anchor) scrollTo(0, places.get(name) ?? 0);
  // The focused element is gone: move the focus to the start of the new view.
  if (hadFocus) byId("main").focus({ preventScroll: true });
}

const help = () => /** @type {HTMLDialogElement} */ (byId("help")).showModal();

const TYPED = "input:not([type=range]):not([type=checkbox]), select, textarea, [contenteditable]";

function onKey(event) {
  const isOpen = byId("help").hasAttribute("open");
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || isOpen) return;
  if (event.target.matches(TYPED)) return;
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
const release = () => [viewerRelease, liveRelease].forEach((end) => end());

/** Called once, by the page. */
export function start() {
  const items = Object.entries(VIEWS).map(([name, [title]]) => h("a", { href: `#${name}`, "data-view": name }, title));
  byId("pages").append(...items);
  byId("keys").addEventListener("click", help);
  addEventListener("keydown", onKey);
  addEventListener("keyup", ({ key }) => key === " " && release());
  addEventListener("blur", release);
  byId("skip").addEventListener("click", (event) => {
    event.preventDefault();
    byId("main").focus();
  });
  history.scrollRestoration = "manual";
  startAnswer(byId("view-answer"));
  onState(show);
  const begin = () => {
    show(state());
    document.body.dataset.ready = String(Math.round(performance.now()));
  };
  // The images come after the script; they are needed only once the page is parsed.
  if (document.readyState === "loading") addEventListener("DOMContentLoaded", begin);
  else begin();
}
