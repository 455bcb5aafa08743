// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/sampler.h"

namespace vernier::sim {

/// What an estimator is told of the true rig, in one trial or for one recorded map.
struct ToldRig {
  Rig rig;
  std::string failure;  ///< why there is none, such as a calibration that failed; empty if there is
};

/// The rigs that an estimator is told of one true rig, by the number of the draw: that of the
/// trial, or 2³¹ + block for a map. All scale the error by psi_c in the truth's tangent
/// (draws from a covariance as calib/sampler.h has it),
///
///     told = truth ⊕ ψ_c (a ⊖ truth)
///
/// with a the rig that ψ_c = 1 tells. The true rig, which makes the images, is the same in all.
class ToldRigs {
 public:
  virtual ~ToldRigs() = default;
  /// The same for the same number, whatever was asked for before; from any thread.
  virtual ToldRig told(std::uint32_t draw) const = 0;
};

/// a = truth ⊕ a draw from `covariance` (RigSampler): exactly `truth` at psi_c = 0. Throws Error
/// (`place`) unless the covariance is over the truth's parameters, by name, and positive
/// semi-definite.
std::shared_ptr<const ToldRigs> drawn_rigs(const Rig& truth,
                                           const Covariance& covariance,
                                           double psi_c,
                                           std::uint64_t seed,
                                           const std::string& place);

/// The same by a sampler, whose mean is the truth.
std::shared_ptr<const ToldRigs> drawn_rigs(RigSampler sampler, double psi_c, std::uint64_t seed);

/// a = `rig` in every draw; exactly it at psi_c = 1, exactly `truth` at 0. Throws Error (`place`)
/// if the number of cameras or an image size differs from the truth's, and, for any other psi_c, if
/// a lens model does.
std::shared_ptr<const ToldRigs> given_rig(const Rig& truth,
                                          const Rig& rig,
                                          double psi_c,
                                          const std::string& place);

}  // namespace vernier::sim
