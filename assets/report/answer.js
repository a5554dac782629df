// Behaviour of the answers, which the page contains: tips and keys of the marks, complete tables, files to save.

import { model } from "report/data";
import { csvText, download, h } from "report/dom";
import { go } from "report/state";
import { dataTable } from "report/tables";

/** More rows of an answer are in its CSV file. */
const ROWS_MAX = 200;

/** The answer that an element belongs to. */
const answerOf = (element) => model.answers[Number(element.closest("[data-answer]").dataset.answer)];

/** The drawing of an answer at the desk's width, as a file. */
function svgText(index) {
  const drawn = document.querySelector(`.figure-box[data-answer="${index}"] .desk svg`);
  const copy = /** @type {Element} */ (drawn.cloneNode(true));
  for (const mark of copy.querySelectorAll(".mark")) {
    const title = document.createElementNS("http://www.w3.org/2000/svg", "title");
    title.textContent = mark.getAttribute("data-tip");
    mark.prepend(title);
    mark.setAttribute("tabindex", "-1");
  }
  return `${new XMLSerializer().serializeToString(copy)}\n`;
}

function save(button) {
  const { name, run, columns, rows } = answerOf(button);
  const stem = model.runs.length > 1 ? `${name}-${run + 1}` : name;
  const index = button.closest("[data-answer]").dataset.answer;
  if (button.dataset.save === "csv") download(`${stem}.csv`, csvText(columns, rows), "text/csv");
  else download(`${stem}.svg`, svgText(index), "image/svg+xml");
}

/** Fills a table of all rows when it is first opened. */
function fill(details) {
  if (!details.open || details.querySelector("table")) return;
  const { columns, rows, row_count: count, name } = answerOf(details);
  const note = details.querySelector(".note");
  if (count > ROWS_MAX) note.prepend(`The first ${ROWS_MAX} of ${count} rows; all of them in `);
  details.append(dataTable(name, columns, rows.slice(0, ROWS_MAX)));
}

// --- Marks -----------------------------------------------------------------------------------------------------------

const tip = h("div", { class: "tip", "aria-hidden": "true", hidden: true });

/** Shows the words of a mark above it, or above the pointer: a line is as long as its figure. */
function showTip(mark, pointer = null) {
  tip.hidden = !mark?.dataset.tip;
  if (tip.hidden) return;
  tip.textContent = mark.dataset.tip;
  const box = pointer ? new DOMRect(pointer.clientX, pointer.clientY, 0, 12) : mark.getBoundingClientRect();
  const { width, height } = tip.getBoundingClientRect();
  const left = Math.min(innerWidth - width - 8, Math.max(8, box.left + box.width / 2 - width / 2));
  const above = box.top - height - 8;
  const top = above < 60 ? box.bottom + 8 : above;
  Object.assign(tip.style, { left: `${left + scrollX}px`, top: `${top + scrollY}px` });
}

/** Makes one mark of a drawing reachable by the tab key. */
function rove(svg, mark) {
  for (const other of svg.querySelectorAll('.mark[tabindex="0"]')) other.setAttribute("tabindex", "-1");
  mark?.setAttribute("tabindex", "0");
}

/** Goes to the images of a mark's cell. */
function follow(mark) {
  if (!mark.dataset.cell) return;
  showTip(null);
  go({ view: "compare", cell: mark.dataset.cell, run: answerOf(mark).run || undefined });
}

/** The mark that an arrow key leads to, by the order of the marks. */
function target(svg, mark, key) {
  const marks = [...svg.querySelectorAll(".mark")];
  const at = marks.indexOf(mark);
  const last = marks.length - 1;
  const next = { ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1, Home: 0, End: last }[key];
  return next === undefined ? null : marks[Math.min(last, Math.max(0, next))];
}

function onMarkKey(event, mark) {
  const next = target(mark.ownerSVGElement, mark, event.key);
  if (next) {
    rove(mark.ownerSVGElement, next);
    next.focus();
  } else if (event.key === "Enter" || event.key === " ") follow(mark);
  else if (event.key === "Escape") showTip(null);
  else return;
  event.preventDefault();
}

/** Called once, with the view of the answers. */
export function startAnswer(view) {
  document.body.append(tip);
  for (const svg of view.querySelectorAll(".figure-box svg")) {
    rove(svg, svg.querySelector(".mark"));
    // The page shows its own tips; a browser would also show the titles of the file.
    for (const title of svg.querySelectorAll(".mark > title")) title.remove();
  }
  const on = (name, selector, act) =>
    view.addEventListener(name, (event) => {
      const found = event.target.closest(selector);
      if (found) act(found, event);
    });
  on("click", "[data-save]", save);
  on("mouseover", ".mark", showTip);
  on("mouseout", ".mark", () => showTip(document.activeElement?.closest(".mark")));
  on("focusin", ".mark", (mark) => {
    rove(mark.ownerSVGElement, mark);
    showTip(mark);
  });
  on("focusout", ".mark", () => showTip(null));
  on("keydown", ".mark", (mark, event) => onMarkKey(event, mark));
  // On a touch screen the first touch shows the tip, the second follows the link.
  on("click", ".mark", (mark, event) => {
    const isFirst = event.pointerType === "touch" && tip.textContent !== mark.dataset.tip;
    if (isFirst) mark.focus();
    else follow(mark);
  });
  view.addEventListener("toggle", (event) => event.target.matches(".all-rows") && fill(event.target), true);
}
