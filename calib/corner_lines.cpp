// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/corner_lines.h"

#include <algorithm>

#include "calib/atomic_file.h"

namespace vernier::corner_lines {

Lines::Lines(const std::filesystem::path& file) : file_(file), text_(read_whole(file)) {}

bool Lines::next(std::string_view& line) {
  if (begin_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
  line = std::string_view(text_).substr(begin_, end - begin_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  begin_ = end + 1;
  ++number_;
  return true;
}

std::vector<std::string_view> split(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  const bool blanks = separators.find(' ') != std::string_view::npos;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    if (!blanks || end > begin) fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

void check_pixel(const Eigen::Vector2d& pixel_px,
                 std::size_t camera,
                 const std::vector<Eigen::Vector2i>& size_px,
                 const std::string& place,
                 const std::string& corner) {
  if (!pixel_px.allFinite()) {
    throw Error(place, corner + ": its pixel is not a finite number", "remove or correct it");
  }
  if (size_px.size() != 1 && camera >= size_px.size()) return;
  const Eigen::Vector2i size = size_px[size_px.size() == 1 ? 0 : camera];
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
    throw Error(file.string(), error.what(), "");
  }
  return observations;
}

}  // namespace vernier::corner_lines
