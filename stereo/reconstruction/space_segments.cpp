// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/space_segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

void check(const SpaceSegmentOptions& o) {
  if (o.max_depth_m > 0 && o.max_relative > 0) return;
  throw Error("space segments", "an option is not above 0", "use a depth and a fraction above 0");
}

/// The part that needs only the rectified geometry.
MeasuredSegment placed(const SegmentDisparity& s,
                       const RectifiedGeometry& g,
                       const SpaceSegmentOptions& options) {
  const Matrix3d R_left_rectified = g.turn.R_rectified_left.transpose();
  MeasuredSegment result;
  Matrix6d J = Matrix6d::Zero();
  for (int end = 0; end < 2; ++end) {
    const Vector2d& at = end == 0 ? s.left_px.a_px : s.left_px.b_px;
    const double d = end == 0 ? s.a_disparity_px : s.b_disparity_px;
    const double z = g.depth_m(d);
    const Vector2d xy = z / g.f_px * (at - g.centre_px);
    const Vector3d p = R_left_rectified * Vector3d(xy.x(), xy.y(), z);
    J.block<3, 2>(3 * end, 2 * end) = z / g.f_px * R_left_rectified.leftCols<2>();
    J.block<3, 1>(3 * end, 4 + end) = -p / d;
    (end == 0 ? result.segment.a_m : result.segment.b_m) = p;
  }
  state_independent_error(result, J, s.covariance_px2, options);
  return result;
}

/// Raw positions of a rectified segment.
std::optional<StereoSegment> raw_segment(const SegmentDisparity& s,
                                         const RawPixels& left,
                                         const RawPixels& right) {
  const ImageSegment other = s.right_px();
  const auto la = left.at(s.left_px.a_px), lb = left.at(s.left_px.b_px);
  const auto ra = right.at(other.a_px), rb = right.at(other.b_px);
  if (!la || !lb || !ra || !rb) return std::nullopt;
  return StereoSegment{{*la, *lb}, {*ra, *rb}, 0};
}

}  // namespace

SegmentStatus status_in_space(const SegmentDisparity& s) {
  if (s.status != SegmentStatus::placed) return s.status;
  const bool in_front = s.a_disparity_px > 0 && s.b_disparity_px > 0;
  return in_front ? SegmentStatus::placed : SegmentStatus::behind;
}

void state_independent_error(MeasuredSegment& s,
                             const Matrix6d& J,
                             const Matrix6d& C_px2,
                             const SpaceSegmentOptions& options) {
  s.independent_m2 = J * C_px2 * J.transpose();
  const double a_z = s.segment.a_m.z(), b_z = s.segment.b_m.z();
  const int farther = a_z > b_z ? 2 : 5;
  s.segment.depth_sigma_m = std::sqrt(s.independent_m2(farther, farther));
  s.segment.reliable = std::max(a_z, b_z) < options.max_depth_m;
}

void judge_linearity(MeasuredSegment& s, const SpaceSegmentOptions& options) {
  const Matrix6d C = s.covariance_m2();
  s.relative_sigma =
      std::max(std::sqrt(C(2, 2)) / s.segment.a_m.z(), std::sqrt(C(5, 5)) / s.segment.b_m.z());
  s.linear = s.relative_sigma <= options.max_relative;
}

std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const SpaceSegmentOptions& options) {
  check(options);
  std::vector<MeasuredSegment> all(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    all[i].status = status_in_space(segments[i]);
    if (all[i].status != SegmentStatus::placed) continue;
    all[i] = placed(segments[i], geometry, options);
    judge_linearity(all[i], options);
  }
  return all;
}

std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const RigEstimate& estimate,
                                            const SpaceSegmentOptions& options) {
  check(options);
  const Rig& rig = estimate.rig;
  if (estimate.covariance && estimate.covariance->matrix.rows() != parameter_count(rig)) {
    throw Error("space segments", "the covariance does not have the size of the rig's parameters",
                "use a rig with its own covariance");
  }
  const RawPixels left(rig, geometry, 0), right(rig, geometry, 1);
  std::vector<MeasuredSegment> all(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    all[i].status = status_in_space(segments[i]);
    if (all[i].status != SegmentStatus::placed) continue;
    const auto raw = raw_segment(segments[i], left, right);
    auto triangulated = raw ? triangulate_with_jacobian(rig, *raw) : std::nullopt;
    if (!triangulated) {
      all[i].status = SegmentStatus::no_ray;
      continue;
    }
    all[i] = placed(segments[i], geometry, options);
    all[i].by_rig = std::move(triangulated->by_rig);
    if (estimate.covariance) {
      all[i].calibration_m2 =
          all[i].by_rig * estimate.covariance->matrix * all[i].by_rig.transpose();
    }
    judge_linearity(all[i], options);
  }
  return all;
}

Eigen::MatrixXd calibration_covariance_m2(std::span<const MeasuredSegment> segments,
                                          const Eigen::MatrixXd& rig_covariance) {
  Eigen::MatrixXd J(6 * static_cast<Eigen::Index>(segments.size()), rig_covariance.rows());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (segments[i].by_rig.cols() != rig_covariance.rows() ||
        rig_covariance.rows() != rig_covariance.cols()) {
      throw Error("space segments",
                  "a segment's derivatives and the covariance differ in the number of parameters",
                  "use segments reconstructed with the rig of the covariance");
    }
    J.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = segments[i].by_rig;
  }
  return J * rig_covariance * J.transpose();
}

}  // namespace vernier::stereo::internal
