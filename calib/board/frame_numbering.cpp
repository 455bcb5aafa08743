// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/frame_numbering.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "calib/error.h"

namespace vernier::internal {

namespace {

/// The last run of digits of a text, and what is left with # in its place.
struct NumberedText {
  std::string rest, digits;
};

std::optional<NumberedText> last_number(const std::string& text) {
  const std::size_t last = text.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(text[first - 1]))) --first;
  return NumberedText{text.substr(0, first) + "#" + text.substr(last + 1),
                      text.substr(first, last + 1 - first)};
}

}  // namespace

ImageName parse_image_name(const std::filesystem::path& image) {
  const std::filesystem::path folder = image.parent_path();
  std::filesystem::path series;
  std::optional<NumberedText> found = last_number(image.stem().string());
  if (found) {
    series = folder / found->rest;
  } else if ((found = last_number(folder.filename().string()))) {
    series = folder.parent_path() / found->rest / image.stem();
  } else {
    throw Error(image.string(), "its name has no frame number",
                "name images like left01.png, right01.png, or 01/left.png, 01/right.png");
  }
  const std::string& digits = found->digits;
  std::int64_t frame = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
  if (parsed.ec != std::errc()) {
    throw Error(image.string(), "its frame number is too large", "use up to 18 digits");
  }
  return {series.string(), frame};
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
