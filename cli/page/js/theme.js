// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

// Okabe and Ito's palette: told apart with every common kind of colour blindness. Those that stand
// for ink and paper change with the theme; plots read them when they are drawn.
const LIGHT = { blue: "#0072b2", sky: "#56b4e9", grey: "#8c99a6", light: "#c9d0d8", ink: "#1d2733",
  paper: "#ffffff", grid: "#e9edf1" };
const DARK = { blue: "#4aa8e0", sky: "#8fd0f5", grey: "#8593a1", light: "#4a5663", ink: "#e3e8ed",
  paper: "#14191f", grid: "#2a323b" };

export const COLOUR = { red: "#d55e00", green: "#009e73", amber: "#e69f00", pink: "#cc79a7", ...LIGHT };

/** The colour of the i-th series. */
export const series_colour = (i) => {
  const { blue, red, green, pink, amber, sky } = COLOUR;
  return [blue, red, green, pink, amber, sky][i % 6];
};

/** Ink for text on a colour: dark where white would have less contrast (WCAG 2). */
export function ink_on(colour) {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.18 ? "#10161d" : "#ffffff";
}

const wish = window.matchMedia?.("(prefers-color-scheme: dark)");

/** As the reader wishes, light on paper. */
export function choose_theme({ paper = false } = {}) {
  Object.assign(COLOUR, wish?.matches && !paper ? DARK : LIGHT);
}

export const on_other_theme = (act) => wish?.addEventListener?.("change", act);

choose_theme();
