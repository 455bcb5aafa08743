// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { is_number } from "./numbers.js";

export const DASH = "–";
export const NBSP = "\u00a0";  // keeps a number and its unit on one line

/** A number with `digits` significant digits, without exponent if readable. */
export function significant(x, digits = 3) {
  if (!is_number(x)) return DASH;
  if (x === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(Number(x.toPrecision(digits)))));
  if (size < -5 || size > 6) return power_of_ten(x, digits, size);
  if (size >= 4) return minus(count(Number(x.toPrecision(digits))));
  return minus(x.toFixed(Math.max(0, Math.min(20, digits - 1 - size))));
}

function power_of_ten(x, digits, size) {
  const raised = String(size).replace("-", "⁻").replace(/\d/g, (d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]);
  const factor = minus((x / 10 ** size).toFixed(Math.max(0, digits - 1)));
  return `${factor}${NBSP}×${NBSP}10${raised}`;
}

export const minus = (text) => text.replace("-", "−");

/** A value with as many decimals as its standard deviation with two digits. */
export function value_beside_sigma(value, sigma) {
  if (!is_number(value)) return DASH;
  if (!is_number(sigma) || sigma <= 0) return significant(value, 6);
  const decimals = 1 - Math.floor(Math.log10(Number(sigma.toPrecision(2))));
  return minus(value.toFixed(Math.max(0, Math.min(12, decimals))));
}

export function fixed(x, decimals) {
  return is_number(x) ? minus(x.toFixed(decimals)) : DASH;
}

export function count(n) {
  return is_number(n) ? n.toLocaleString("en-GB", { maximumFractionDigits: 0 }) : DASH;
}

/** A fraction in [0, 1] as a percentage. */
export function percent(share, decimals = 1) {
  return is_number(share) ? `${(100 * share).toFixed(decimals)}${NBSP}%` : DASH;
}

export function range_percent(range) {
  if (!Array.isArray(range) || !range.every(is_number)) return DASH;
  return `${(100 * range[0]).toFixed(1)} to ${(100 * range[1]).toFixed(1)}${NBSP}%`;
}

export function metres(x) {
  if (!is_number(x)) return DASH;
  return x < 1 ? `${significant(100 * x, 2)}${NBSP}cm` : `${significant(x, 3)}${NBSP}m`;
}

export function milliseconds(x) {
  return is_number(x) ? `${significant(x, x >= 100 ? 4 : 3)}${NBSP}ms` : DASH;
}

export function p_value(p) {
  if (!is_number(p)) return DASH;
  return p < 0.001 ? "< 0.001" : p.toFixed(3);
}

/** "1 trial", "900 trials". */
export const counted = (n, noun) => `${count(n)} ${noun}${n === 1 ? "" : "s"}`;

/** Text for Plotly, which interprets tags: escaped, with the index of ψ_c as subscript. */
export function plot_text(text) {
  const entities = { "&": "&amp;", "<": "&lt;", ">": "&gt;" };
  const escaped = String(text ?? "").replace(/[&<>]/g, (c) => entities[c]);
  return escaped.replace(/([ψσ])_([a-z]+)/g, "$1<sub>$2</sub>");
}

/** A settings value for display. */
export function setting(value) {
  if (value === null || value === undefined) return DASH;
  if (is_number(value)) return minus(String(value));
  if (typeof value === "object") return JSON.stringify(value);
  return String(value);
}
