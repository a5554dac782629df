// The address's hash holds what is shown, so that every view has a link: #compare?cell=...&mode=error.

const listeners = new Set();
let current = parse();

function parse() {
  const [view, query] = location.hash.slice(1).split("?", 2);
  return { ...Object.fromEntries(new URLSearchParams(query ?? "")), view: view || "answer" };
}

/** The state as text for a link. */
export function link(state) {
  const { view, ...rest } = state;
  const given = Object.entries(rest).filter(([, value]) => value !== undefined && value !== "");
  const query = new URLSearchParams(given).toString();
  return `#${view}${query ? `?${query}` : ""}`;
}

export const state = () => current;

/** Browsers refuse more than about a hundred changes of the address in half a minute; a slider makes them in one. */
const WRITE_MS = 400;
let [written, timer] = [-Infinity, 0];

function write() {
  clearTimeout(timer);
  timer = 0;
  written = performance.now();
  history.replaceState(null, "", link(current));
}

/** Writes pending changes. */
function flush() {
  if (timer) write();
}

/** Goes to another view; it becomes an entry of the browser's history. */
export function go(next) {
  flush();
  if (link(next) === location.hash) return;
  history.pushState(null, "", link(next));
  changed();
}

/** Changes details of the view that is shown; an empty value removes one. Calls no listener: the caller has drawn. */
export function keep(details) {
  current = { ...current, ...details };
  if (timer) return;
  const wait = written + WRITE_MS - performance.now();
  if (wait <= 0) write();
  else timer = setTimeout(write, wait);
}

/** Calls `listener` when the state changes. */
export const onState = (listener) => listeners.add(listener);

function changed() {
  // Pending changes belong to the history entry that has been left.
  clearTimeout(timer);
  timer = 0;
  current = parse();
  for (const listener of listeners) listener(current);
}

addEventListener("hashchange", changed);
addEventListener("popstate", changed);
addEventListener("pagehide", flush);
// A link leaves the entry: pending changes are written first.
addEventListener("click", flush, { capture: true });
