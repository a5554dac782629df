// Links to the files of a run.

import { h } from "report/dom";

/** The contact sheets beside the report, which hold every image of a scene as pictures. */
export const sheetLinks = (run) =>
  h("p", { class: "sheets" }, ...run.sheets.map(([name, link], i) => [i ? " · " : "", h("a", { href: link }, name)]));
