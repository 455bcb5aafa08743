// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/packed_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/epipolar_kernel.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/loss.h"
#include "calib/solver/view_kernel.h"

namespace vernier::internal {
namespace {

EpipolarSums unpacked(const std::vector<double>& sums, int columns, double cost) {
  const int p = columns - 1;
  EpipolarSums result{Eigen::MatrixXd(p, p), Eigen::VectorXd(p), cost};
  for (int i = 0; i < p; ++i) {
    for (int j = i; j < p; ++j) {
      result.information(i, j) = result.information(j, i) = sums[packed_index(i, j, columns)];
    }
    result.gradient[i] = sums[packed_index(i, p, columns)];
  }
  return result;
}

EpipolarSums sums_of(const Lanes* lanes, std::size_t eights, const Rig& rig, const Loss& loss) {
  const EpipolarView view(rig);
  const int columns = epipolar_columns(view);
  std::vector<double> sums(packed_size(columns), 0.0);
  const double cost = sum_pairs(view, lanes, eights, loss, sums.data());
  return unpacked(sums, columns, cost);
}

}  // namespace

PackedPairs::PackedPairs(const PairObservations& pairs, const std::vector<double>& weights)
    : pairs_(pairs.size()) {
  for (const ImagePair& image : pairs.image_pairs) {
    const std::size_t eights = (image.count + kernel_lanes - 1) / kernel_lanes;
    groups_.push_back({values_.size() / packed_pair_lanes, eights, image.first, image.count});
    for (std::size_t e = 0; e < eights * kernel_lanes; ++e) {
      const std::size_t lane = e % kernel_lanes;
      if (lane == 0) values_.resize(values_.size() + packed_pair_lanes);
      Lanes* const to = &values_[values_.size() - packed_pair_lanes];
      const std::size_t row = image.first + std::min(e, image.count - 1);
      for (int i = 0; i < 4; ++i) to[i].of[lane] = pairs.pixels_px[row][i];
      const double weight = weights.empty() ? 1 : weights[row];
      to[4].of[lane] = e < image.count ? std::sqrt(weight) / pairs.sigma_of(row) : 0;
    }
  }
}

std::vector<double> PackedPairs::residuals(const Rig& rig) const {
  std::vector<double> padded(eights() * kernel_lanes), residuals(pairs_);
  pair_residuals(EpipolarView(rig), values_.data(), eights(), padded.data());
  for (const Group& group : groups_) {
    std::copy_n(padded.begin() + static_cast<std::ptrdiff_t>(group.first * kernel_lanes),
                group.count, residuals.begin() + static_cast<std::ptrdiff_t>(group.row));
  }
  return residuals;
}

EpipolarSums epipolar_sums(const PackedPairs& packed,
                           const PackedPairs::Group& group,
                           const Rig& rig,
                           const Loss& loss) {
  return sums_of(packed.lanes(group), group.eights, rig, loss);
}

EpipolarSums epipolar_sums(const PackedPairs& packed, const Rig& rig, const Loss& loss) {
  return sums_of(packed.lanes({}), packed.eights(), rig, loss);
}

}  // namespace vernier::internal
