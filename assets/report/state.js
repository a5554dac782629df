// The address's hash holds what is shown, so that every view has a link: #compare?cell=...&mode=error.

const listeners = new Set();
let current = parse();

function parse() {
  const [view, query] = decodeURI(location.hash.slice(1)).split("?", 2);
  return { view: view || "answer", ...Object.fromEntries(new URLSearchParams(location.hash.split("?")[1] ?? query ?? "")) };
}

/** The state as text for a link. */
export function link(state) {
  const { view, ...rest } = state;
  const parameters = new URLSearchParams(Object.entries(rest).filter(([, value]) => value !== undefined && value !== ""));
  const query = parameters.toString();
  return `#${view}${query ? `?${query}` : ""}`;
}

export const state = () => current;

/** Goes to another view; it becomes an entry of the browser's history. */
export function go(next) {
  if (link(next) === location.hash) return;
  history.pushState(null, "", link(next));
  changed();
}

/** Changes details of the view that is shown. An empty value removes one. Tells nobody: the caller has drawn already. */
export function keep(details) {
  current = { ...current, ...details };
  history.replaceState(null, "", link(current));
}

/** Calls `listener` when another state is to be shown. */
export const onState = (listener) => listeners.add(listener);

function changed() {
  current = parse();
  for (const listener of listeners) listener(current);
}

addEventListener("hashchange", changed);
addEventListener("popstate", changed);
