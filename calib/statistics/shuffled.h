// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/statistics/random.h"

namespace vernier::internal {

/// The numbers in a random order, all orders equally probable (Fisher and Yates 1938). The first k
/// are a sample without replacement, whatever k.
std::vector<int> shuffled(std::vector<int> numbers, const RandomCounter& place);

}  // namespace vernier::internal
