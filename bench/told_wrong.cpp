// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "told_wrong.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/triangulation.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

namespace vernier::bench {

using namespace stereo;
using namespace stereo::internal;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double farthest_m = 1000;
constexpr double least_px = 10;

Vector3d right_centre_m(const Rig& rig) {
  const Pose& pose = rig.T_camera_first[1];
  return -pose.R.transpose() * pose.t;
}

}  // namespace

RigEstimate with_covariance_of(const Rig& rig, const RigEstimate& calibrated) {
  RigEstimate estimate;
  estimate.rig = rig;
  for (Camera& camera : estimate.rig.cameras) {
    if (model_name(camera.model) == "opencv4") continue;
    camera.model = OpenCv4{};
    const Eigen::VectorXd core = camera.parameters.head(core_parameter_count);
    camera.parameters = Eigen::VectorXd::Zero(parameter_count(camera.model));
    camera.parameters.head(core_parameter_count) = core;
  }
  Covariance covariance = required_covariance(calibrated, "calibrated rig");
  if (covariance.names != parameter_names(estimate.rig)) {
    throw Error("calibrated rig", "has other parameters than a pair of opencv4",
                "calibrate a pair with --model opencv4");
  }
  const double pixels = estimate.rig.cameras[0].f_px() / calibrated.rig.cameras[0].f_px();
  const double metres = right_centre_m(rig).norm() / right_centre_m(calibrated.rig).norm();
  for (Eigen::Index i = 0; i < covariance.matrix.rows(); ++i) {
    const std::string& name = covariance.names[std::size_t(i)];
    const double scale = name.ends_with("_px") ? pixels : name.ends_with("_m") ? metres : 1;
    covariance.matrix.row(i) *= scale;
    covariance.matrix.col(i) *= scale;
  }
  estimate.covariance = std::move(covariance);
  return estimate;
}

std::vector<PlacedLine> reconstructed(const Rig& told,
                                      const RawPair& pair,
                                      const DisparityRange& range) {
  const RectifiedGeometry geometry = rectified_geometry(told);
  const RectifiedImages images = rectified_images(told, geometry, pair.left, pair.right);
  CannyOptions canny;
  canny.noise = images.pair.left_noise.per_pixel();
  const std::vector<EdgePoint> edges = canny_edges(images.pair.left, canny);
  const auto found = edge_matcher().match(images.pair, edges, range);
  std::vector<PlacedLine> lines;
  for (const SegmentDisparity& s : segment_disparities(edges, edge_segments(edges), found)) {
    if (s.status != SegmentStatus::placed || s.left_px.length_px() < least_px) continue;
    const auto a = raw_pixel(told, geometry, 0, s.left_px.a_px);
    const auto b = raw_pixel(told, geometry, 0, s.left_px.b_px);
    if (!a || !b) continue;
    const auto in_space = [&](const Vector2d& px, double disparity_px) -> Vector3d {
      const double z = geometry.depth_m(disparity_px);
      const Vector2d xy = z / geometry.f_px * (px - geometry.centre_px);
      return geometry.turn.R_rectified_left.transpose() * Vector3d(xy.x(), xy.y(), z);
    };
    lines.push_back({{*a, *b},
                     in_space(s.left_px.a_px, s.a_disparity_px),
                     in_space(s.left_px.b_px, s.b_disparity_px)});
  }
  return lines;
}

DisparityRange range_with(const Rig& told,
                          const Rig& true_rig,
                          const std::vector<PlacedLine>& lines,
                          const DisparityRange& range) {
  constexpr double spare_px = 8;
  const RectifiedGeometry geometry = rectified_geometry(told);
  double least = range.min_px, most = range.max_px;
  for (const PlacedLine& line : lines) {
    for (const Vector3d& end : {line.a_m, line.b_m}) {
      const auto raw = pixel_pair(true_rig, end);
      if (!raw) continue;
      const auto left = rectified_pixel(told, geometry, 0, raw->first_px);
      const auto right = rectified_pixel(told, geometry, 1, raw->other_px);
      if (!left || !right) continue;
      least = std::min(least, left->x() - right->x() - spare_px);
      most = std::max(most, left->x() - right->x() + spare_px);
    }
  }
  const int last = geometry.size_px[0] / 2;
  return {std::max(-last, int(std::floor(least))), std::min(last, int(std::ceil(most)))};
}

const PlacedLine* like(const std::vector<PlacedLine>& lines,
                       const ImageSegment& px,
                       double most_off_px) {
  const Vector2d a = px.a_px, t = (px.b_px - a).normalized(), n(-t.y(), t.x());
  const double length = px.length_px();
  const PlacedLine* best = nullptr;
  double least = most_off_px;
  for (const PlacedLine& line : lines) {
    const ImageSegment& s = line.left_px;
    if ((s.b_px - s.a_px).normalized().dot(t) < 0.995) continue;  // 5.7 deg
    const double from = t.dot(s.a_px - a), to = t.dot(s.b_px - a);
    const double overlap = std::min(to, length) - std::max(from, 0.0);
    if (overlap < 0.6 * length || overlap < 0.6 * (to - from)) continue;
    const double off = std::max(std::abs(n.dot(s.a_px - a)), std::abs(n.dot(s.b_px - a)));
    if (off < least) {
      least = off;
      best = &line;
    }
  }
  return best;
}

std::optional<Vector3d> on_ray(const PlacedLine& line, const Vector3d& ray) {
  const Vector3d d = line.b_m - line.a_m, r = ray.normalized();
  const Vector3d across = d - r.dot(d) * r;  // of the ray
  const double t = -across.dot(line.a_m - r.dot(line.a_m) * r) / across.squaredNorm();
  const Vector3d p = line.a_m + t * d;
  if (!(std::abs(t - 0.5) < 1) || !(p.z() > 0) || p.z() > farthest_m) return {};
  return p;
}

SimulatedPair::SimulatedPair(const Rig& true_rig,
                             const std::vector<PlacedLine>& lines,
                             double sigma_px,
                             std::uint32_t trial,
                             std::uint32_t frame)
    : sensed_(lines.size()) {
  sim::SourceSettings sources = sim::no_sources();
  sources.endpoint_sigma_px = sigma_px;
  const sim::Sensor sensor(true_rig, sources);
  sim::NoiseFreeView view;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    sim::VisibleEdge edge;
    edge.a_m = lines[i].a_m;
    edge.b_m = lines[i].b_m;
    edge.feature = std::uint32_t(i);
    edge.object_centre_m = edge.a_m;
    view.edges.push_back(edge);
  }
  const sim::StereoObservation seen =
      sensor.sense(view, {.seed = 1, .trial = trial, .frame = frame});
  for (const StereoSegment& segment : seen.segments) sensed_[segment.feature / 2] = segment;
}

std::vector<std::optional<PlacedLine>> SimulatedPair::placed_with(const Rig& told) const {
  std::vector<std::optional<PlacedLine>> lines(sensed_.size());
  for (std::size_t i = 0; i < sensed_.size(); ++i) {
    if (!sensed_[i]) continue;
    const SpaceSegment s = triangulate(told, *sensed_[i], {.max_depth_m = farthest_m});
    if (s.reliable) lines[i] = PlacedLine{sensed_[i]->left, s.a_m, s.b_m};
  }
  return lines;
}

bool is_physical(const Rig& drawn, const Rig& true_rig) {
  const Vector3d baseline = right_centre_m(true_rig);
  return parameters(drawn).allFinite() &&
         right_centre_m(drawn).dot(baseline) > 0.1 * baseline.squaredNorm() &&
         drawn.cameras[0].f_px() > 0 && drawn.cameras[1].f_px() > 0;
}

}  // namespace vernier::bench
