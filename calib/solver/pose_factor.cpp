// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/pose_factor.h"

#include <string>

#include "calib/error.h"

namespace vernier::internal {

Eigen::LLT<Eigen::Matrix<double, 6, 6>> pose_factor(const Eigen::Matrix<double, 6, 6>& BtB,
                                                    int frame) {
  Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(BtB);
  const Eigen::Array<double, 6, 1> pivots = factor.matrixLLT().diagonal().array().square();
  if (factor.info() != Eigen::Success ||
      !(pivots > min_pose_pivot * BtB.diagonal().array()).all()) {
    throw Error("frame " + std::to_string(frame),
                "its corners do not determine the pose of the board", "leave the frame out");
  }
  return factor;
}

}  // namespace vernier::internal
