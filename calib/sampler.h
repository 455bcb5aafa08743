// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier {

namespace internal {
class StableCoordinates;
struct MovedRig;
}  // namespace internal

/// Sampling options. Draw i of a seed is one rig and, given it, one board pose per frame.
struct SamplingOptions {
  double psi_c = 1;  ///< factor on all standard deviations of the calibration
  int samples = 2000;
  std::uint64_t seed = 1;
};

/// Samples rigs around an estimate by the SVD of its scaled covariance (Tina Memo 2017-001):
///
///     a = â ⊕ ψ_c D U √s z,   z ~ N(0, I),   D⁻¹ C D⁻¹ = U diag(s) Uᵀ
///
/// ⊕ moves a rig along the valley of rigs that see nearly the same
/// (calib/estimate/stable_coordinates.h); to first order it is the tangent of calib/rig.h, and
/// where a draw is too far from the mean, exactly that. ψ_c scales standard deviations: at ψ_c = 2
/// every deviation is exactly twice that at ψ_c = 1 under the same seed.
class RigSampler {
 public:
  /// Throws Error if the estimate has no covariance or one that is not positive semi-definite.
  explicit RigSampler(const RigEstimate& estimate, const std::string& place = "rig");

  /// Deviation in the tangent of draw `trial` under `seed`. Throws Error if it overflows, or
  /// psi_c is negative or not a number.
  Eigen::VectorXd deviation(double psi_c, std::uint64_t seed, std::uint32_t trial) const;

  /// The rig of that draw, all its parameters finite; otherwise throws Error. Wide covariances give
  /// rigs that no cameras can have, such as a negative focal length.
  Rig sample(double psi_c, std::uint64_t seed, std::uint32_t trial) const;

  /// The rig at a deviation.
  vernier::internal::MovedRig moved(const Eigen::VectorXd& deviation) const;

  const ScaledDecomposition& decomposition() const { return decomposition_; }
  const Rig& mean() const { return mean_; }

 private:
  std::string place_;
  Rig mean_;
  ScaledDecomposition decomposition_;
  std::shared_ptr<const vernier::internal::StableCoordinates> coordinates_;
};

}  // namespace vernier
