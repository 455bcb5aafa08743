// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/epipolar_kernel.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/loss.h"

namespace vernier::internal {

/// Matched pairs in groups of eight, image pair by image pair, the last group of each padded.
class PackedPairs {
 public:
  PackedPairs() = default;  ///< of no pairs
  /// Weights multiply squared residuals; one per row, or none.
  explicit PackedPairs(const PairObservations& pairs, const std::vector<double>& weights = {});

  struct Group {
    std::size_t first = 0, eights = 0;  ///< in eights
    std::size_t row = 0, count = 0;     ///< its rows in the observations
  };
  const std::vector<Group>& groups() const { return groups_; }
  const Lanes* lanes(const Group& group) const {
    return values_.data() + group.first * packed_pair_lanes;
  }
  std::size_t eights() const { return values_.size() / packed_pair_lanes; }
  std::size_t pairs() const { return pairs_; }

  /// Residuals of every row, in standard deviations.
  std::vector<double> residuals(const Rig& rig) const;

 private:
  std::vector<Lanes> values_;
  std::vector<Group> groups_;
  std::size_t pairs_ = 0;
};

/// The sums of a row (J, r) over pairs: Σ w J Jᵀ, Σ w r J, Σ ρ(r).
struct EpipolarSums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double cost = 0;
};

/// For one image pair, or for all.
EpipolarSums epipolar_sums(const PackedPairs& packed,
                           const PackedPairs::Group& group,
                           const Rig& rig,
                           const Loss& loss);
EpipolarSums epipolar_sums(const PackedPairs& packed, const Rig& rig, const Loss& loss);

}  // namespace vernier::internal
