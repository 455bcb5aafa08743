// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vernier::internal {

/// Camera and frame of an image from its name.
struct ImageName {
  std::string camera;      ///< folder and name without the number
  std::int64_t frame = 0;  ///< the number; its frame by FrameNumbering
};

/// The last number in an image's name, or else in that of its folder. Throws Error if there is
/// none, or one of more than 18 digits.
ImageName parse_image_name(const std::filesystem::path& image);

/// Frame numbers of images from the numbers in their names: the numbers themselves if all are below
/// 2147483648, else (time stamps in nanoseconds) their ranks from 0 in ascending order.
class FrameNumbering {
 public:
  explicit FrameNumbering(std::vector<std::int64_t> numbers);

  /// The frame of one of the numbers given to the constructor.
  int frame(std::int64_t number) const;

 private:
  std::vector<std::int64_t> in_order_;  ///< empty if the numbers are the frames
};

}  // namespace vernier::internal
