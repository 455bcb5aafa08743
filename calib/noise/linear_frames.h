// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"

namespace vernier::internal {

/// Corners that one or more views show; those views have the same C in each coordinate.
struct PointSet {
  std::vector<int> ids;
  Eigen::MatrixXd squared_distances_m2;
  int coordinates = 0;  ///< u and v of each of its views
  /// Σ d dᵀ over these, d the derivatives of the coordinate's corners by their points' x, then y,
  /// then z: 3n x 3n; empty without a shape.
  Eigen::MatrixXd shape_products;
};

/// A view's part of a frame's columns Y = [rig, motion, pose, residual]; other columns are zero.
struct LinearView {
  int camera = 0;
  std::size_t set = 0;
  std::vector<Eigen::Index> columns;
  Eigen::MatrixXd Yt;         ///< columns x 2n: u of all corners, then v
  Eigen::Matrix3Xd by_point;  ///< 3 x 2n; empty without a shape
};

struct LinearFrame {
  int frame = 0;
  std::vector<LinearView> views;
  std::vector<Eigen::Matrix3d> motion_axes;  ///< of each camera but the first
};

/// How many unknowns there are: z, those of all frames (rig, then x, y and z of every point of the
/// shape), and a frame's own x (motion, then pose).
struct Unknowns {
  Eigen::Index rig = 0, shape = 0, motion = 0;

  Eigen::Index common() const { return rig + shape; }
  Eigen::Index own() const { return motion + 6; }
  Eigen::Index residual() const { return rig + own(); }  ///< its column in Y
  Eigen::Index columns() const { return residual() + 1; }
};

/// A linearised calibration, its rows sorted by what does not change with the components.
struct LinearFrames {
  /// Throws Error for frames without views.
  LinearFrames(const std::vector<FrameRows>& frames,
               const std::vector<Eigen::Vector3d>& target_m,
               NoiseParts parts);

  Unknowns unknowns;
  std::vector<PointSet> sets;
  std::vector<LinearFrame> frames;
};

/// Σ d dᵀ of one view, as in PointSet.
Eigen::MatrixXd shape_products(const Eigen::Matrix3Xd& by_point);

}  // namespace vernier::internal
