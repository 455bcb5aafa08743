// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/frame_numbering.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace vernier::internal {

FrameNumbering::FrameNumbering(std::vector<std::int64_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  if (numbers.empty() || numbers.back() <= std::numeric_limits<int>::max()) return;
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  in_order_ = std::move(numbers);
}

int FrameNumbering::frame(std::int64_t number) const {
  if (in_order_.empty()) return static_cast<int>(number);
  return static_cast<int>(std::lower_bound(in_order_.begin(), in_order_.end(), number) -
                          in_order_.begin());
}

}  // namespace vernier::internal
