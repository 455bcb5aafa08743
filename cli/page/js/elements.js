// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { DASH, NBSP } from "./format.js";

/** Creates an element; strings among `children` become text, with the index of ψ_c as subscript. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined && value !== false) made.setAttribute(name, value);
  }
  made.append(...children.flat(Infinity).flatMap(nodes_of));
  return made;
}

export function nodes_of(child) {
  if (child === null || child === undefined || child === false) return [];
  if (child instanceof Node) return [child];
  return String(child).split(/([ψσ]_[a-z]+)/).map((piece, i) => {
    if (i % 2 === 0) return document.createTextNode(piece);
    const sub = document.createElement("sub");
    sub.textContent = piece.slice(2);
    const both = document.createDocumentFragment();
    both.append(piece[0], sub);
    return both;
  });
}

/** A box of warnings or doubts; null where there are none. */
export function findings(heading, list) {
  if (!list?.length) return null;
  return element("div", { class: "warning", role: "note" }, element("strong", {}, heading),
    element("ul", {}, list.map((words) => element("li", {}, words))));
}

export const paragraph = (...children) => element("p", {}, ...children);

// Of several studies each has its sections, with ids of their own and without entries in the contents.
let part = "";

/** The id of a section in the part of the page that is being made. */
export const part_id = (id) => `${id}${part}`;

/** Makes sections of one of several parts. */
export function in_part(suffix, make) {
  part = suffix;
  make();
  part = "";
}

/** Adds a section to the page, and to the table of contents as `nav` (null: not listed). */
export function section_named(name, heading, nav, ...children) {
  const id = part_id(name);
  const made = element("section", { id, "aria-labelledby": `${id}-heading` },
    element("h2", { id: `${id}-heading` }, heading), ...children);
  document.getElementById("report").append(made);
  if (nav && !part) {
    document.getElementById("contents").append(
      element("li", {}, element("a", { href: `#${id}` }, nav)));
  }
  return made;
}

export const section = (id, heading, ...children) => section_named(id, heading, heading, ...children);

/**
 * A table. A column: {head, small (second line of the head), text (left aligned), cell: row =>
 * content}. Columns that contain only dashes are omitted.
 */
export function table(caption, columns, rows, { chosen = () => false, wide = true } = {}) {
  const filled = columns.filter((column) => rows.some((row) => column.cell(row) !== DASH));
  const head = element("tr", {}, filled.map((column) =>
    element("th", { scope: "col", class: column.text ? "text" : null }, column.head,
      column.small && element("span", { class: "small" }, column.small))));
  const body = rows.map((row) => element("tr", { class: chosen(row) ? "chosen" : null },
    filled.map((column, i) => element(i === 0 ? "th" : "td",
      { scope: i === 0 ? "row" : null, class: column.text ? "text" : "number" },
      keep_together(column.cell(row))))));
  return element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    element("table", { class: wide ? "wide" : null }, element("caption", {}, element("span", {}, caption)),
      element("thead", {}, head), element("tbody", {}, body)));
}

/** Keeps short texts on one line; longer ones may break anywhere except in "ψ_c = 10". */
function keep_together(content) {
  if (typeof content !== "string") return content;
  return content.length <= 24 ? content.replaceAll(" ", NBSP)
    : content.replaceAll(" = ", `${NBSP}=${NBSP}`);
}

export const small = (text) => element("span", { class: "small" }, text);

/** Buttons for up to six labels, otherwise a list; calls `choose(index)` on a change. */
export function chooser(legend, labels, first, choose) {
  if (labels.length > 6) {
    const list = element("select", { "aria-label": legend },
      labels.map((label, i) => element("option", { value: i, selected: i === first }, label)));
    list.addEventListener("change", () => choose(Number(list.value)));
    return element("div", { class: "chooser" }, element("label", {}, legend, " ", list));
  }
  const buttons = labels.map((label, i) => {
    const pressed = String(i === first);
    const button = element("button", { type: "button", "aria-pressed": pressed }, label);
    button.addEventListener("click", () => {
      buttons.forEach((other) => other.setAttribute("aria-pressed", String(other === button)));
      choose(i);
    });
    return button;
  });
  return element("fieldset", { class: "chooser" }, element("legend", {}, legend), buttons);
}
