// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// What is drawn: switches with their colours, and at a pose the number of edges of each kind.

/** Colours of Okabe and Ito, which are told apart by everybody. */
const taken = ["#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#f0e442", "#a0522d", "#8844cc", "#555555"];

export function coloursOf(dark) {
  return { edges: dark ? "#8a96a3" : "#7d8894", route: "#009e73", told: dark ? "#4aa3df" : "#0072b2" };
}

export function layersOf(legend, data, colours, changed) {
  const switches = new Map();
  const painted = new Map();

  function add(name, text, colour, on) {
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = on;
    box.addEventListener("change", changed);
    const key = document.createElement("span");
    key.className = "key";
    key.style.background = colour;
    const words = document.createElement("span");
    words.textContent = text;
    const count = document.createElement("span");
    count.className = "count";
    label.append(box, key, words, count);
    legend.append(label);
    switches.set(name, { box, label, count });
    painted.set(name, colour);
  }

  add("surfaces", "surfaces", "#c4ccd4", true);
  add("edges", "all edges", colours.edges, true);
  if (data.route.length > 0) add("route", "route", colours.route, true);
  data.kinds.forEach((kind, i) => {
    const colour = kind.name === "told" ? colours.told : taken[(i - 1 + taken.length) % taken.length];
    add(kind.name, kind.text, colour, true);
  });

  return {
    on: (name) => switches.has(name) && switches.get(name).box.checked,
    colour: (name) => painted.get(name),
    count(view) {
      for (const kind of data.kinds) {
        const n = (view.edges[kind.name] || []).length / 6;
        const { label, count } = switches.get(kind.name);
        count.textContent = String(n);
        label.classList.toggle("none", n === 0);
      }
    },
  };
}
