// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/frame_numbering.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/error.h"

namespace vernier::internal {

ImageName parse_image_name(const std::filesystem::path& image) {
  const std::string stem = image.stem().string();
  const std::size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) {
    throw Error(image.string(), "its name has no frame number",
                "name images like left01.png, right01.png");
  }
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(stem[first - 1]))) --first;
  std::int64_t frame = 0;
  const auto parsed = std::from_chars(stem.data() + first, stem.data() + last + 1, frame);
  if (parsed.ec != std::errc()) {
    throw Error(image.string(), "its frame number is too large", "use up to 18 digits");
  }
  return {(image.parent_path() / (stem.substr(0, first) + "#" + stem.substr(last + 1))).string(),
          frame};
}

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
