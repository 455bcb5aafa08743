// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vernier::internal {

/// How an image belongs to a rig by its name.
struct ImageName {
  std::string camera;      ///< the name without its last number
  std::int64_t frame = 0;  ///< the last number; its frame by FrameNumbering
};

/// Throws Error for a name without a number, or with one of more than 18 digits.
ImageName parse_image_name(const std::filesystem::path& image);

/// Frames of images by the numbers in their names: the numbers themselves where all of them are
/// below 2147483648; else (time stamps in nanoseconds) their places, from 0, in ascending order of
/// all that differ.
class FrameNumbering {
 public:
  explicit FrameNumbering(std::vector<std::int64_t> numbers);

  /// Of one of the numbers given.
  int frame(std::int64_t number) const;

 private:
  std::vector<std::int64_t> in_order_;  ///< empty where numbers are frames
};

}  // namespace vernier::internal
