// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0

export const is_number = (x) => typeof x === "number" && Number.isFinite(x);

export const upper = (lengths, share) =>
  lengths.sort((a, b) => a - b)[Math.floor(share * (lengths.length - 1))];

export const sum_of = (list, term) => list.reduce((sum, one) => sum + term(one), 0);
