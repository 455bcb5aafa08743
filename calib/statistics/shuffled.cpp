// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/shuffled.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "calib/statistics/random.h"

namespace vernier::internal {

std::vector<int> shuffled(std::vector<int> numbers, const RandomCounter& place) {
  RandomStream draws(place);
  for (std::size_t i = 0; i + 1 < numbers.size(); ++i) {
    const auto left = static_cast<std::uint32_t>(numbers.size() - i);
    std::swap(numbers[i], numbers[i + draws.below(left)]);
  }
  return numbers;
}

}  // namespace vernier::internal
