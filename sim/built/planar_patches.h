// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/built/depth_cloud.h"

namespace vernier::sim::internal {

struct PatchOptions {
  double largest_m = 0.8;   ///< cells that are tried first
  double smallest_m = 0.1;  ///< cells are halved down to this
  double flat_m = 0.025;    ///< standard deviation of points from their plane, at most
  int least_points = 12;
  int least_views = 2;     ///< that saw it
  double filled = 0.7;     ///< share of a patch on which points lie, at least
  double sample_m = 0.05;  ///< a point fills a square of this size
};

/// A flat part of a surface.
struct Patch {
  std::vector<Eigen::Vector3d> polygon_m;  ///< convex, in one plane
  Eigen::Vector3d normal;                  ///< towards the cameras that saw it
  int views = 0;
};

/// The flat parts of surfaces that points lie on. Space is divided into cells; the points of a cell
/// make a patch if they are near one plane (least squares) and fill it; else the cell is halved in
/// all directions. A patch is the least octagon around its points in the plane, a few of them aside
/// in each direction, so that a stray point does not widen it. What is curved or cluttered below
/// the smallest cell is left out: it hides nothing.
std::vector<Patch> planar_patches(const DepthCloud& cloud, const PatchOptions& options = {});

}  // namespace vernier::sim::internal
