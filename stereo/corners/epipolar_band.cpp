// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/epipolar_band.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "calib/base/plane_vectors.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::stereo::internal {
namespace {

constexpr int first_steps = 16;
constexpr int max_halvings = 7;
constexpr int edge_halvings = 12;  // of a step, to where the curve leaves the image's surroundings
constexpr double longest_step_px = 24;
constexpr double straight_px = 0.1;

bool near_image(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Array2d size = camera.size_px.cast<double>().array();
  return (pixel.array() > -0.5 * size).all() && (pixel.array() < 1.5 * size).all();
}

}  // namespace

/// The ray of a left pixel and its derivatives by the pixel and the left intrinsics.
struct EpipolarBand::Ray {
  Eigen::Vector3d direction;                           ///< (x, y, 1), left frame
  Eigen::Matrix2d by_pixel;                            ///< of (x, y)
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_camera;  ///< of (x, y), by the left intrinsics
  Eigen::Matrix2d covariance_px2;
};

EpipolarBand::EpipolarBand(const Rig& rig,
                           const Eigen::MatrixXd& covariance,
                           const BandOptions& options)
    : rig_(rig), covariance_(covariance), options_(options) {
  if (rig.cameras.size() != 2) {
    throw Error("rig", "it has " + std::to_string(rig.cameras.size()) + " cameras instead of 2",
                "use the rig of the two cameras that took the images");
  }
  const Eigen::Index n = parameter_count(rig);
  if (covariance.rows() != n || covariance.cols() != n) {
    throw Error("rig", "the covariance does not have the size of its parameters",
                "use both of one rig");
  }
  if (!(options.nearest_m > 0) || !(options.corner_sigma_px >= 0)) {
    throw Error("epipolar band", "nearest_m is not above 0 or corner_sigma_px is negative",
                "use metres and pixels");
  }
}

std::optional<BandNode> EpipolarBand::node(const Ray& ray, double inverse_depth) const {
  const Pose& T = rig_.T_camera_first[1];
  const Eigen::Vector3d turned = T.R * ray.direction;
  const Eigen::Vector3d x = turned + inverse_depth * T.t;  // the point divided by its left depth
  if (!(x.z() > 1e-3 * x.norm())) return std::nullopt;
  ProjectionJacobian J;
  BandNode node{inverse_depth, project(rig_.cameras[1], x, J)};
  const bool folded = !(J.point.leftCols<2>().determinant() > 0);
  if (folded || !near_image(rig_.cameras[1], node.pixel_px)) return std::nullopt;

  const Eigen::Matrix2d by_ray = J.point * T.R.leftCols<2>();
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_rig(2, covariance_.cols());
  by_rig.setZero();
  by_rig.leftCols(ray.by_camera.cols()) = by_ray * ray.by_camera;
  by_rig.middleCols(intrinsics_index(rig_, 1), J.camera.cols()) = J.camera;
  by_rig.middleCols<3>(pose_index(rig_, 1)) = -J.point * hat(turned);
  by_rig.middleCols<3>(pose_index(rig_, 1) + 3) = inverse_depth * J.point;
  node.right_by_left = by_ray * ray.by_pixel;
  const double floor = options_.corner_sigma_px * options_.corner_sigma_px;
  node.covariance_px2 = by_rig * covariance_ * by_rig.transpose() +
                        node.right_by_left * ray.covariance_px2 * node.right_by_left.transpose() +
                        floor * Eigen::Matrix2d::Identity();
  return node;
}

/// Appends the nodes after the last one up to `to`.
void EpipolarBand::subdivide(const Ray& ray,
                             const BandNode& to,
                             int depth,
                             std::vector<BandNode>& nodes) const {
  const BandNode from = nodes.back();
  const double middle = 0.5 * (from.inverse_depth + to.inverse_depth);
  const auto between = depth < max_halvings ? node(ray, middle) : std::nullopt;
  if (between) {
    const Eigen::Vector2d chord = to.pixel_px - from.pixel_px;
    const Eigen::Vector2d off = between->pixel_px - from.pixel_px;
    const double bend =
        std::abs(vernier::internal::cross(chord, off)) / std::max(chord.norm(), 1e-12);
    if (chord.norm() > longest_step_px || bend > straight_px) {
      subdivide(ray, *between, depth + 1, nodes);
      subdivide(ray, to, depth + 1, nodes);
      return;
    }
  }
  nodes.push_back(to);
  nodes.back().follows = true;
}

/// The last node between one near the image and an inverse depth whose node is not.
BandNode EpipolarBand::edge(const Ray& ray, BandNode in, double out) const {
  for (int i = 0; i < edge_halvings; ++i) {
    const double middle = 0.5 * (in.inverse_depth + out);
    if (const auto between = node(ray, middle)) {
      in = *between;
    } else {
      out = middle;
    }
  }
  in.follows = false;
  return in;
}

std::vector<BandNode> EpipolarBand::curve(const UncertainPixel& left) const {
  const Camera& camera = rig_.cameras[0];
  const auto direction = try_unproject(camera, left.pixel_px);
  if (!direction) return {};
  ProjectionJacobian J;
  project(camera, *direction, J);
  Ray ray{*direction, J.point.leftCols<2>().inverse(), {}, left.covariance_px2};
  ray.by_camera = -ray.by_pixel * J.camera;

  std::vector<BandNode> nodes;
  double before = 0;  // inverse depth of the last step
  bool joined = false;
  for (int i = 0; i <= first_steps; ++i) {
    const double here = i / (first_steps * options_.nearest_m);
    const auto next = node(ray, here);
    if (i > 0 && next && !joined) nodes.push_back(edge(ray, *next, before));
    if (next && (i > 0)) {
      subdivide(ray, *next, 0, nodes);
    } else if (next) {
      nodes.push_back(*next);
    } else if (joined) {
      const BandNode last = edge(ray, nodes.back(), here);
      subdivide(ray, last, 0, nodes);
    }
    joined = next.has_value();
    before = here;
  }
  return nodes;
}

BandDistance distance_to_step(const std::vector<BandNode>& curve,
                              std::size_t i,
                              const UncertainPixel& right) {
  BandDistance distance;
  const BandNode &a = curve[i - 1], &b = curve[i];
  if (!b.follows) return distance;
  const Eigen::Matrix2d information =
      (0.5 * (a.covariance_px2 + b.covariance_px2) + right.covariance_px2).inverse();
  const Eigen::Vector2d step = b.pixel_px - a.pixel_px, to = right.pixel_px - a.pixel_px;
  const double length2 = step.dot(information * step);
  const double unclamped = length2 > 0 ? step.dot(information * to) / length2 : 0;
  const double t = std::clamp(unclamped, 0.0, 1.0);
  const Eigen::Vector2d off = to - t * step;
  const bool at_start = i == 1 || !a.follows;
  const bool at_end = i + 1 == curve.size() || !curve[i + 1].follows;
  const bool beyond = (at_start && unclamped < 0) || (at_end && unclamped > 1);
  distance.mahalanobis2 = off.dot(information * off);
  distance.dof = beyond ? 2 : 1;
  distance.inverse_depth = a.inverse_depth + t * (b.inverse_depth - a.inverse_depth);
  distance.right_by_left = a.right_by_left + t * (b.right_by_left - a.right_by_left);
  if (step.norm() > 0) distance.direction = step.normalized();
  return distance;
}

BandDistance distance_to_curve(const std::vector<BandNode>& curve, const UncertainPixel& right) {
  BandDistance least;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const BandDistance distance = distance_to_step(curve, i, right);
    if (distance.mahalanobis2 < least.mahalanobis2) least = distance;
  }
  return least;
}

}  // namespace vernier::stereo::internal
