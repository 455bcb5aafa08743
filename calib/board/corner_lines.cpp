// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/corner_lines.h"

#include <fmt/format.h>

#include <cstddef>

#include "calib/board_observations.h"
#include "calib/error.h"

namespace vernier::internal::corner_lines {

void check_pixel(const Eigen::Vector2d& pixel_px,
                 std::size_t camera,
                 const std::vector<Eigen::Vector2i>& size_px,
                 const std::string& place,
                 const std::string& corner) {
  if (!pixel_px.allFinite()) {
    throw Error(place, corner + ": its pixel is not a finite number", "remove or correct it");
  }
  if (size_px.size() != 1 && camera >= size_px.size()) return;
  const Eigen::Vector2i& size = size_px[size_px.size() == 1 ? 0 : camera];
  const Eigen::Array2d from_edge = pixel_px.array() + 0.5;
  if ((from_edge >= 0).all() && (from_edge <= size.cast<double>().array()).all()) return;
  throw Error(place,
              fmt::format("{}: its pixel ({}, {}) lies outside the image of {}x{}", corner,
                          pixel_px.x(), pixel_px.y(), size.x(), size.y()),
              "check the image size, or that the corners belong to these images");
}

BoardObservations finished(BoardObservations observations,
                           std::size_t cameras,
                           const std::filesystem::path& file) {
  if (observations.size_px.size() == 1) {
    observations.size_px.resize(cameras, Eigen::Vector2i(observations.size_px[0]));
  }
  try {
    check_and_sort(observations);
  } catch (const Error& error) {
    throw Error(file.string(), error.place() + ": " + error.fault(), error.remedy());
  }
  return observations;
}

}  // namespace vernier::internal::corner_lines
