// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { half_room_px } from "./plot.js";

export const image_height = ([width, height]) => Math.round(
  118 + Math.min(450, half_room_px() - 76) * height / width);

/** Centres of a structure's columns or rows, in pixels. */
export const cell_centres = (cells, size) =>
  Array.from({ length: cells }, (_, i) => (i + 0.5) * size / cells - 0.5);

/** A structure's list as rows of a heat map. */
function grid_of({ columns, rows }, list) {
  return Array.from({ length: rows }, (_, y) => list.slice(y * columns, (y + 1) * columns));
}

/** The image's cells as a heat map below the other traces. */
export const cells_trace = ({ structure, size_px }, list, more) => ({
  type: "heatmap", x: cell_centres(structure.columns, size_px[0]),
  y: cell_centres(structure.rows, size_px[1]), z: grid_of(structure, list), xgap: 1, ygap: 1,
  ...more,
});

/** 1, 2 or 5 times a power of ten that scales `long` to about the fraction `share` of the width. */
export function magnification(long, width, share) {
  if (!(long > 0)) return 1;
  const wanted = share * width / long;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = [5, 2, 1].find((s) => s * power <= wanted) ?? 1;
  return Math.max(1, step * power);
}
