// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {

/// Eight frames processed together.
struct FrameGroup {
  /// One camera's views in these frames.
  struct Seen {
    std::size_t first = 0;  ///< row of its first corner in the packed arrays
    int corners = 0;        ///< of the view with most; 0 if no frame shows the board
    std::array<int, kernel_lanes> views{};  ///< index into the observations, -1 for none
  };
  std::array<int, kernel_lanes> frames{};  ///< index into the state's frames, -1 for none
  std::vector<Seen> cameras;
};

/// Board observations with frames in lanes. Frames with similar corner counts share a group, so
/// that few lanes are idle; views with fewer corners than their group are padded with weight 0.
class PackedViews {
 public:
  /// Weights are sqrt(w) / pixel_sigma_px with the w of the problem. If the warp is known, the
  /// target is warped by state.warp_m; if it is free, the shapes are stored with each corner.
  /// Observations must be sorted (check_and_sort) and their frames be the state's, else Error.
  PackedViews(const BoardObservations& observations,
              const BoardState& state,
              const ReprojectionProblem& problem);

  const std::vector<FrameGroup>& groups() const { return groups_; }
  bool warp() const { return warp_; }
  std::size_t corners() const { return slots_.size(); }  ///< as observed, without padding

  /// Pixels, one column per corner in the order of the observations, in the kernels' layout. Throws
  /// Error if the number is wrong or, naming the corner, if a pixel is not finite.
  std::vector<Lanes> pack(const Eigen::Matrix2Xd& pixels_px) const;
  Eigen::Matrix2Xd observed_px(const BoardObservations& observations) const;

  /// The lanes of a camera in a group; pose as in ViewLanes, `state` for model and warp.
  ViewLanes lanes(const FrameGroup& group,
                  int camera,
                  const BoardState& state,
                  const double* intrinsics,
                  const double* pose,
                  const std::vector<Lanes>& pixels) const;

 private:
  bool warp_;
  std::vector<FrameGroup> groups_;
  std::vector<Lanes> target_;                       // rows of 4 (or 6)
  std::vector<std::pair<std::size_t, int>> slots_;  // row and lane of every corner
};

/// T_camera_board of eight frames, as in ViewLanes; idle lanes repeat the first.
void camera_poses(const BoardState& state, int camera, const FrameGroup& group, Lanes (&poses)[12]);

/// f_x f_y o_x o_y k1 … of a camera.
Eigen::VectorXd kernel_intrinsics(const Camera& camera);

/// The matrix that maps a change in the rig's tangent to a change of the kernels' parameters (f_x
/// f_y o_x o_y k …, twists of T_camera_first), to first order at `rig`.
Eigen::MatrixXd kernel_by_tangent(const Rig& rig);

}  // namespace vernier::internal
