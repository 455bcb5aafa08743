// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/statistics/random.h"

namespace vernier::sim::internal {

/// A draw from the Poisson distribution of this mean, up to 1e9: by inversion below a mean of 10,
/// else by transformed rejection, algorithm PTRS of Hörmann, "The transformed rejection method for
/// generating Poisson random variables", Insurance: Mathematics and Economics 12 (1993). Exact.
double draw_poisson(vernier::internal::RandomStream& draws, double mean);

}  // namespace vernier::sim::internal
