// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "calib/base/utf8.h"

/// What the files of a rig may hold: beyond this they are broken, and sums of products would
/// overflow. The covariance of 32 cameras with 8 distortion coefficients has 570 rows, and its
/// eigenvalues take half a second.
namespace vernier::internal {

constexpr std::size_t most_cameras = 32;
constexpr std::size_t most_name_bytes = 100;
constexpr int most_side_px = 1'000'000;
constexpr double most_value = 1e9;          ///< of a camera's or a pose's parameter
constexpr double most_variance = 1e30;      ///< of one
constexpr double most_focal_ratio = 1'000;  ///< f_x over f_y, or f_y over f_x

/// Whether a camera may have this name, which is part of the names of its parameters: not too long,
/// on one line, and UTF-8, which JSON can hold.
inline bool is_camera_name(std::string_view name) {
  const auto acts = [](char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7f; };
  return name.size() <= most_name_bytes && std::none_of(name.begin(), name.end(), acts) &&
         first_bad_utf8(name) == std::string_view::npos;
}

}  // namespace vernier::internal
