// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

export const is_number = (x) => typeof x === "number" && Number.isFinite(x);

// JavaScript converts JSON's null (no value) to 0; these functions keep it null, which is shown as a
// gap in plots and a dash in tables.
export const times = (factor, x) => is_number(x) ? factor * x : null;
export const in_percent = (share) => times(100, share);
export const ratio = (a, b) => is_number(a) && is_number(b) && b !== 0 ? a / b : null;
export const less = (a, b) => is_number(a) && is_number(b) ? a - b : null;

/** The quantile `share` of the list; sorts the list. */
export const upper = (lengths, share) =>
  lengths.sort((a, b) => a - b)[Math.floor(share * (lengths.length - 1))];

export const sum_of = (list, term) => list.reduce((sum, one) => sum + term(one), 0);

/** Error bars in per cent from fractions and their intervals; none where either is missing. */
export function bars_in_percent(shares, ranges, more) {
  return { type: "data", symmetric: false, ...more,
    array: shares.map((share, i) => in_percent(less(ranges[i]?.[1], share))),
    arrayminus: shares.map((share, i) => in_percent(less(share, ranges[i]?.[0]))) };
}
