// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/segments_file.h"

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "calib/base/all_within.h"
#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "localise/join/line_fit.h"
#include "localise/joined_lines.h"
#include "localise/views/depth_view.h"
#include "localise/views/view_json.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"

namespace vernier::localise::internal {

using vernier::internal::JsonNode;
using vernier::internal::TextLines;

namespace {

constexpr std::size_t most_segments = 100'000;
constexpr double farthest_m = 1000, largest_m2 = 1e6;

Json numbers(const auto& v) { return Json(std::vector<double>(v.begin(), v.end())); }

Eigen::Vector3d point(const JsonNode& node) {
  const Eigen::Vector3d p = node.vector3();
  if (!all_within(p, farthest_m)) {
    throw Error(node.place(), "is farther than 1,000 m", "give metres");
  }
  return p;
}

Eigen::Matrix<double, 6, 6> covariance(const JsonNode& node) {
  const Eigen::MatrixXd C = node.matrix();
  if (C.rows() != 6) throw Error(node.place(), "is not 6 x 6", "give that of both ends");
  if (!all_within(C, largest_m2) || !(C.diagonal().minCoeff() >= 0)) {
    throw Error(node.place(), "has a variance that is not from 0 to 1e6 m2",
                "correct it, or leave the segment out");
  }
  if ((C - C.transpose()).cwiseAbs().maxCoeff() > 1e-6 * C.cwiseAbs().maxCoeff()) {
    throw Error(node.place(), "is not symmetric", "correct it");
  }
  if (!is_semidefinite(C)) {
    throw Error(node.place(), "is not positive semidefinite", "correct it");
  }
  return C;
}

ImageSegmentInSpace parse_segment(const JsonNode& node) {
  ImageSegmentInSpace segment;
  const Eigen::VectorXd px = node.at("image_px").vector();
  constexpr double farthest_px = 1e6;
  if (px.size() != 4 || !all_within(px, farthest_px)) {
    throw Error(node.at("image_px").place(), "is not four numbers up to 1e6", "give u, v, u, v");
  }
  segment.image_px = {px.head<2>(), px.tail<2>()};
  if (!(segment.image_px.length_px() > 1e-6)) {
    throw Error(node.at("image_px").place(), "its ends are the same pixel",
                "leave the segment out");
  }
  segment.in_space = {point(node.at("a_m")), point(node.at("b_m")),
                      covariance(node.at("covariance_m2"))};
  if (!((segment.in_space.b_m - segment.in_space.a_m).norm() > 1e-6)) {
    throw Error(node.place(), "is a segment of no length", "leave it out");
  }
  if (node.has("reliable")) {
    const JsonNode reliable = node.at("reliable");
    if (!reliable.json().is_boolean()) {
      throw Error(reliable.place(), "is neither true nor false", "correct it");
    }
    segment.reliable = reliable.json().get<bool>();
  }
  return segment;
}

/// What nearly has no disparity lies kilometres off.
bool can_be_read(const stereo::internal::MeasuredSegment& s) {
  return all_within(s.segment.a_m, farthest_m) && all_within(s.segment.b_m, farthest_m) &&
         all_within(s.independent_m2, largest_m2);
}

SegmentsOfImage parse_image(const JsonNode& node) {
  SegmentsOfImage image;
  image.image = node.at("image").text();
  const JsonNode list = node.at("segments");
  list.array();  // or throws
  if (list.size() > most_segments) {
    throw Error(list.place(), "holds more than 100,000 segments", "leave some out");
  }
  for (std::size_t i = 0; i < list.size(); ++i) image.segments.push_back(parse_segment(list.at(i)));
  return image;
}

}  // namespace

SegmentsOfImage segments_of(const std::string& image, const DepthSegments& segments) {
  SegmentsOfImage result{image, {}};
  for (std::size_t i = 0; i < segments.image.size(); ++i) {
    const stereo::internal::MeasuredSegment& s = segments.in_space[i];
    if (s.status != stereo::internal::SegmentStatus::placed || !can_be_read(s)) continue;
    result.segments.push_back(
        {segments.image[i], {s.segment.a_m, s.segment.b_m, s.independent_m2}, s.segment.reliable});
  }
  return result;
}

std::vector<SegmentsOfImage> read_segments(const std::filesystem::path& file) {
  constexpr std::size_t most_images = 100'000, longest_line = 256'000'000;
  std::vector<SegmentsOfImage> images;
  std::set<std::string> names;
  TextLines lines(file, longest_line);
  std::string_view line;
  while (lines.next(line)) {
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (images.size() == most_images) {
      throw Error(lines.place(), "is one of more than 100,000 images", "split the file");
    }
    const Json json = vernier::internal::parse_json_line(line, lines.place());
    images.push_back(parse_image(JsonNode(json, lines.place() + ":")));
    if (!names.insert(images.back().image).second) {
      throw Error(lines.place(),
                  vernier::internal::in_quotes(images.back().image) + " is there a second time",
                  "leave one out: a view counts once");
    }
  }
  if (images.empty()) {
    throw Error(file.string(), "holds no segments",
                "give a file of vernier lines --segments, see file-formats");
  }
  return images;
}

std::string segments_line(const SegmentsOfImage& image) {
  Json list = Json::array();
  for (const ImageSegmentInSpace& s : image.segments) {
    Json covariance = Json::array();
    for (int row = 0; row < 6; ++row) {
      const Eigen::Matrix<double, 6, 1> values = s.in_space.covariance_m2.row(row);
      covariance.push_back(numbers(values));
    }
    const auto& [a_px, b_px] = s.image_px;
    list.push_back({{"image_px", {a_px.x(), a_px.y(), b_px.x(), b_px.y()}},
                    {"a_m", numbers(s.in_space.a_m)},
                    {"b_m", numbers(s.in_space.b_m)},
                    {"covariance_m2", covariance},
                    {"reliable", s.reliable}});
  }
  return Json{{"image", image.image}, {"segments", list}}.dump() + "\n";
}

}  // namespace vernier::localise::internal
