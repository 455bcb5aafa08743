// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calib/board_state.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

/// A pose in Ceres' parameters: rotation vector (radians) and translation (metres). Its derivative
/// is the left tangent's times J_l, which avoids Ceres' manifolds and their half angles.
inline void write_block(const Pose& pose, double* block) {
  Eigen::Map<Eigen::Vector3d>{block} = vector_from_rotation(pose.R);
  Eigen::Map<Eigen::Vector3d>(block + 3) = pose.t;
}

inline Pose read_block(const double* b) {
  return {rotation_from_vector({b[0], b[1], b[2]}), {b[3], b[4], b[5]}};
}

/// All parameters in one piece of memory. Ceres orders blocks by address, so separate allocations
/// would let the order of its sums, and the last bits of the result, vary between runs.
class ParameterBuffer {
 public:
  explicit ParameterBuffer(const BoardState& state)
      : rig_(state.rig), intrinsics_(pose_index(rig_, 1)), cameras_(rig_.cameras.size()) {
    values_.resize(intrinsics_ + 6 * (cameras_ + state.frames.size()) + 2);
    for (std::size_t c = 0; c < cameras_; ++c) {
      const Eigen::VectorXd& a = rig_.cameras[c].parameters;
      std::copy(a.begin(), a.end(), intrinsics(static_cast<int>(c)));
      write_block(rig_.T_camera_first[c], camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      write_block(state.T_first_board[f], board(f));
    }
    std::copy(state.warp_m.begin(), state.warp_m.end(), warp());
  }

  double* intrinsics(int camera) { return values_.data() + intrinsics_index(rig_, camera); }
  double* camera_pose(int camera) { return values_.data() + intrinsics_ + 6 * camera; }
  double* warp() { return values_.data() + intrinsics_ + 6 * cameras_; }
  double* board(std::size_t frame) {
    return values_.data() + intrinsics_ + 6 * (cameras_ + frame) + 2;
  }
  const double* intrinsics(int c) const { return values_.data() + intrinsics_index(rig_, c); }
  const double* camera_pose(int c) const { return values_.data() + intrinsics_ + 6 * c; }
  const double* warp() const { return values_.data() + intrinsics_ + 6 * cameras_; }
  const double* board(std::size_t frame) const {
    return values_.data() + intrinsics_ + 6 * (cameras_ + frame) + 2;
  }

  void write_to(BoardState& state) const {
    for (std::size_t c = 0; c < cameras_; ++c) {
      Eigen::VectorXd& a = state.rig.cameras[c].parameters;
      a = Eigen::Map<const Eigen::VectorXd>(intrinsics(static_cast<int>(c)), a.size());
      if (c > 0) state.rig.T_camera_first[c] = read_block(camera_pose(static_cast<int>(c)));
    }
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      state.T_first_board[f] = read_block(board(f));
    }
    state.warp_m = Eigen::Map<const Eigen::Vector2d>(warp());
  }

 private:
  Rig rig_;
  std::size_t intrinsics_, cameras_;
  std::vector<double> values_;
};

}  // namespace vernier::internal
