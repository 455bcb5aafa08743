// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/triangulation_uncertainty.h"

#include "calib/camera/other_camera.h"
#include "calib/error.h"
#include "calib/estimate/covariance_check.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/pose_covariance.h"

namespace vernier {

using namespace internal;

namespace {

constexpr const char* triangulation_place = "triangulation uncertainty";

}  // namespace

TriangulationUncertainty::TriangulationUncertainty(const RigAndBoards& joint,
                                                   TriangulationFrame frame,
                                                   int other)
    : rig_(joint.rig), other_(other), stabilised_(frame == TriangulationFrame::stabilised) {
  check_other(rig_, other);
  check_covariance(joint.rig_covariance, rig_, triangulation_place);
  covariance_ = stabilised_ ? rig_and_motion_covariance(joint) : joint.rig_covariance;
}

TriangulationUncertainty::TriangulationUncertainty(const Rig& rig,
                                                   const Eigen::MatrixXd& rig_covariance,
                                                   int other)
    : rig_(rig), other_(other), covariance_(rig_covariance) {
  check_other(rig, other);
  check_covariance(covariance_, rig, triangulation_place);
}

TriangulationUncertainty::Sensitivity TriangulationUncertainty::sensitivity(
    const PointTriangulation& point) const {
  if (!stabilised_) return point.by_rig;
  Sensitivity S(3, covariance_.cols());
  S << point.by_rig, hat(point.x_m), -Eigen::Matrix3d::Identity();  // -(w × x) = [x]x w
  return S;
}

std::optional<TriangulatedPoint> TriangulationUncertainty::at(const PixelPair& pair,
                                                              double pair_sigma_px) const {
  if (!(pair_sigma_px >= 0)) {
    throw Error(triangulation_place, "the pair's pixel noise is negative or not a number",
                "give it in pixels");
  }
  const auto point = triangulate_point_with_jacobian(rig_, pair, other_);
  if (!point) return std::nullopt;
  const Sensitivity S = sensitivity(*point);
  const Eigen::Matrix3d C = S * covariance_ * S.transpose();
  return TriangulatedPoint{
      point->x_m, 0.5 * (C + C.transpose()),
      pair_sigma_px * pair_sigma_px * point->by_pixels * point->by_pixels.transpose()};
}

std::optional<Eigen::Matrix3d> TriangulationUncertainty::between(const PixelPair& a,
                                                                 const PixelPair& b) const {
  const auto at_a = triangulate_point_with_jacobian(rig_, a, other_);
  const auto at_b = triangulate_point_with_jacobian(rig_, b, other_);
  if (!at_a || !at_b) return std::nullopt;
  return sensitivity(*at_a) * covariance_ * sensitivity(*at_b).transpose();
}

}  // namespace vernier
