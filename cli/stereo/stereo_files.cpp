// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/stereo_files.h"

#include <cmath>
#include <cstddef>
#include <optional>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "cli/stereo/stereo_input.h"
#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/rectification.h"
#include "stereo/rectification/rectification_covariance.h"

namespace vernier::cli {
namespace {

Json json_of(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    rows.push_back(Json::array());
    for (Eigen::Index j = 0; j < m.cols(); ++j) rows.back().push_back(m(i, j));
  }
  return rows;
}

template <class Vector>
Json triple(const Vector& v) {
  Json values = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) values.push_back(v[i]);
  return values;
}

Json line_json(const SegmentDisparity& line) {
  return {{"edge", line.segment},
          {"part", line.is_part},
          {"left_px", {triple(line.left_px.a_px), triple(line.left_px.b_px)}},
          {"disparity_px", {line.a_disparity_px, line.b_disparity_px}},
          {"image_covariance_px2", json_of(line.covariance_px2)},
          {"edge_points", line.edge_points},
          {"agreeing_points", line.points.size()},
          {"rms_px", line.rms_px}};
}

void add_space(const MeasuredSegment& s, Json& json) {
  json["a_m"] = triple(s.segment.a_m);
  json["b_m"] = triple(s.segment.b_m);
  json["independent_m2"] = json_of(s.independent_m2);
  if (s.by_rig.cols() > 0) {
    json["calibration_m2"] = json_of(s.calibration_m2);
    json["by_rig"] = json_of(s.by_rig);
  }
  json["relative_sigma"] = s.relative_sigma;
  json["linear"] = s.linear;
  json["reliable"] = s.segment.reliable;
}

bool is_placed(const StereoResult& result, std::size_t i) {
  const SegmentStatus status =
      result.placed.empty() ? result.lines[i].status : result.placed[i].status;
  return status == SegmentStatus::placed;
}

Json head_json(const StereoInput& input) {
  Json head{{"format", "vernier/segments"}, {"version", 1}};
  if (!input.geometry) return head;
  const RectifiedGeometry& g = *input.geometry;
  head["frame"] = "left camera";
  head["rectified"] = {{"f_px", g.f_px},
                       {"centre_px", triple(g.centre_px)},
                       {"baseline_m", g.baseline_m},
                       {"disparity_offset_px", input.offset_px},
                       {"R_rectified_left", json_of(g.turn.R_rectified_left)}};
  if (!input.estimate) return head;
  head["parameter_names"] = parameter_names(input.estimate->rig);
  if (input.estimate->covariance) {
    head["rig_covariance"] = json_of(input.estimate->covariance->matrix);
  }
  return head;
}

/// Standard deviation of an edge's disparity due to rig errors; empty if unknown.
std::optional<double> by_calibration(const RectificationUncertainty& rectified,
                                     const EdgePoint& edge,
                                     double disparity_px) {
  const auto C = rectified.covariance_px2(Eigen::Vector2d(edge.row_x_px, edge.y), disparity_px);
  if (!C) return std::nullopt;
  const double variance = disparity_variance_px2(*C, edge.normal.cast<double>());
  if (!std::isfinite(variance)) return std::nullopt;
  return std::sqrt(variance);
}

}  // namespace

std::string status_key(SegmentStatus status) {
  switch (status) {
    case SegmentStatus::placed:
      return "placed";
    case SegmentStatus::along_row:
      return "along_row";
    case SegmentStatus::unmatched:
      return "unmatched";
    case SegmentStatus::disagree:
      return "disagree";
    case SegmentStatus::behind:
      return "behind";
    case SegmentStatus::no_ray:
      return "no_ray";
  }
  return "";
}

std::string edges_csv(const StereoInput& input, const StereoResult& result) {
  std::vector<int> segment_of(result.edges.size(), -1);
  for (std::size_t i = 0; i < result.segments.size(); ++i) {
    for (const int p : result.segments[i].points) {
      segment_of[static_cast<std::size_t>(p)] = static_cast<int>(i);
    }
  }
  std::optional<RectificationUncertainty> rectified;
  if (input.geometry && input.estimate && input.estimate->covariance) {
    rectified.emplace(input.estimate->rig, input.estimate->covariance->matrix, *input.geometry);
  }
  std::string csv =
      "x,y,u_px,normal_x,normal_y,strength,edge_sigma_px,disparity_px,sigma_px,"
      "calibration_sigma_px,confidence,depth_m,segment\n";
  for (std::size_t i = 0; i < result.edges.size(); ++i) {
    const EdgePoint& e = result.edges[i];
    csv += fmt::format("{},{},{},{},{},{},{},", e.x, e.y, e.row_x_px, e.normal.x(), e.normal.y(),
                       e.strength, e.sigma_px);
    const EdgeDisparity& d = result.found[i];
    if (d.matched()) {
      const double whole = d.disparity_px + input.offset_px;
      csv += fmt::format("{},", d.disparity_px);
      csv += (std::isfinite(d.sigma_px) ? fmt::format("{}", d.sigma_px) : "") + ",";
      const auto sigma = rectified ? by_calibration(*rectified, e, whole) : std::nullopt;
      csv += (sigma ? fmt::format("{:.6g}", *sigma) : "") + ",";
      csv += fmt::format("{},", d.confidence);
      csv += (input.geometry && whole > 0 ? fmt::format("{:.9g}", input.geometry->depth_m(whole))
                                          : "") +
             ",";
    } else {
      csv += ",,,,,";
    }
    csv += segment_of[i] < 0 ? "\n" : fmt::format("{}\n", segment_of[i]);
  }
  return csv;
}

std::string segments_json(const StereoInput& input, const StereoResult& result) {
  Json refused = Json::array();
  std::string segments;
  for (std::size_t i = 0; i < result.lines.size(); ++i) {
    const SegmentDisparity& line = result.lines[i];
    if (!is_placed(result, i)) {
      const SegmentStatus status =
          line.status == SegmentStatus::placed ? result.placed[i].status : line.status;
      refused.push_back({{"edge", line.segment},
                         {"left_px", {triple(line.left_px.a_px), triple(line.left_px.b_px)}},
                         {"reason", status_key(status)}});
      continue;
    }
    Json json = line_json(line);
    if (!result.placed.empty()) add_space(result.placed[i], json);
    segments += (segments.empty() ? "\n" : ",\n") + json.dump();
  }
  std::string text = head_json(input).dump();
  text.pop_back();  // the closing brace
  return text + ",\n\"segments\": [" + segments + "],\n\"refused\": " + refused.dump() + "}\n";
}

std::string segments_csv(const StereoResult& result) {
  const bool space = !result.placed.empty();
  std::string csv = space ? "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,z1_matching_sigma_m,z2_matching_sigma_m,"
                            "z1_calibration_sigma_m,z2_calibration_sigma_m,linear,reliable,"
                          : "";
  csv +=
      "u1_px,v1_px,u2_px,v2_px,disparity1_px,disparity2_px,disparity1_sigma_px,"
      "disparity2_sigma_px,points,edge\n";
  for (std::size_t i = 0; i < result.lines.size(); ++i) {
    if (!is_placed(result, i)) continue;
    const SegmentDisparity& line = result.lines[i];
    if (space) {
      const MeasuredSegment& s = result.placed[i];
      const auto sigma = [](const Eigen::Matrix<double, 6, 6>& C, int k) {
        return std::sqrt(C(k, k));
      };
      for (const Eigen::Vector3d& end : {s.segment.a_m, s.segment.b_m}) {
        csv += fmt::format("{:.9g},{:.9g},{:.9g},", end.x(), end.y(), end.z());
      }
      csv += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:d},{:d},", sigma(s.independent_m2, 2),
                         sigma(s.independent_m2, 5), sigma(s.calibration_m2, 2),
                         sigma(s.calibration_m2, 5), s.linear, s.segment.reliable);
    }
    csv += fmt::format("{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.6g},{:.6g},{},{}\n",
                       line.left_px.a_px.x(), line.left_px.a_px.y(), line.left_px.b_px.x(),
                       line.left_px.b_px.y(), line.a_disparity_px, line.b_disparity_px,
                       std::sqrt(line.covariance_px2(4, 4)), std::sqrt(line.covariance_px2(5, 5)),
                       line.points.size(), line.segment);
  }
  return csv;
}

std::string segments_ply(const StereoResult& result) {
  std::string vertices, edges;
  int count = 0;
  for (const MeasuredSegment& s : result.placed) {
    if (s.status != SegmentStatus::placed || !s.segment.reliable) continue;
    for (const Eigen::Vector3d& end : {s.segment.a_m, s.segment.b_m}) {
      vertices += fmt::format("{:.9g} {:.9g} {:.9g}\n", end.x(), end.y(), end.z());
    }
    edges += fmt::format("{} {}\n", 2 * count, 2 * count + 1);
    ++count;
  }
  return fmt::format(
             "ply\nformat ascii 1.0\ncomment left camera frame, metres\nelement vertex {}\n"
             "property double x\nproperty double y\nproperty double z\nelement edge {}\n"
             "property int vertex1\nproperty int vertex2\nend_header\n",
             2 * count, count) +
         vertices + edges;
}

}  // namespace vernier::cli
