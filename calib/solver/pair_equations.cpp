// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/pair_equations.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/epipolar_system.h"
#include "calib/solver/loss.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/packed_pairs.h"

namespace vernier::internal {

ReducedNormalEquations pair_equations(const PairObservations& pairs,
                                      const Rig& rig,
                                      const Loss& loss,
                                      double sigma_scale) {
  const PackedPairs packed(pairs);
  const std::vector<double> residuals = packed.residuals(rig);
  double bend = 0, count = 0;
  for (const double r : residuals) {
    if (!(weight_of(loss, r / sigma_scale) > 0)) continue;
    bend += curvature_of(loss, r / sigma_scale);
    ++count;
  }
  constexpr double min_bend = 0.3;  // below, the loss does not suit the residuals
  const double mean_bend = count > 0 ? std::max(min_bend, bend / count) : 1;
  std::vector<double> counted;
  counted.reserve(residuals.size());
  for (const double r : residuals) {
    counted.push_back(weight_of(loss, r / sigma_scale) > 0 ? mean_bend : 0);
  }
  const PackedPairs inliers(pairs, counted);
  const auto groups = static_cast<Eigen::Index>(packed.groups().size());
  const int p = parameter_count(rig);
  ReducedNormalEquations equations;
  equations.information = Eigen::MatrixXd::Zero(p, p);
  equations.scores = Eigen::MatrixXd::Zero(p, groups);
  for (Eigen::Index g = 0; g < groups; ++g) {
    const PackedPairs::Group& group = packed.groups()[static_cast<std::size_t>(g)];
    const EpipolarSums weighted = scaled_sums(packed, &group, rig, loss, sigma_scale);
    const EpipolarSums plain = scaled_sums(inliers, &group, rig, {}, sigma_scale);
    equations.information += plain.information;
    equations.frame_information.push_back(plain.information);
    equations.scores.col(g) = weighted.gradient;
    equations.chi2 += weighted.cost;
    equations.frame_chi2.push_back(weighted.cost);
    equations.residuals += static_cast<int>(group.count);
  }
  equations.held_poses_diagonal = equations.information.diagonal();
  return equations;
}

void add_equations(ReducedNormalEquations& equations, const ReducedNormalEquations& more) {
  equations.information += more.information;
  equations.held_poses_diagonal += more.held_poses_diagonal;
  Eigen::MatrixXd scores(equations.scores.rows(), equations.scores.cols() + more.scores.cols());
  scores << equations.scores, more.scores;
  equations.scores = std::move(scores);
  equations.frame_information.insert(equations.frame_information.end(),
                                     more.frame_information.begin(), more.frame_information.end());
  equations.chi2 += more.chi2;
  equations.frame_chi2.insert(equations.frame_chi2.end(), more.frame_chi2.begin(),
                              more.frame_chi2.end());
  equations.residuals += more.residuals;
}

PairObservations split_into_cells(const PairObservations& pairs,
                                  const Eigen::Vector2i& size_px,
                                  int cells) {
  PairObservations split;
  for (std::size_t k = 0; k < pairs.image_pairs.size(); ++k) {
    const ImagePair& image = pairs.image_pairs[k];
    for (int cell = 0; cell < cells * cells; ++cell) {
      const int number = static_cast<int>(k) * cells * cells + cell;
      for (std::size_t i = image.first; i < image.first + image.count; ++i) {
        const Eigen::Array2d at =
            cells * (pairs.pixels_px[i].head<2>().array() + 0.5) / size_px.cast<double>().array();
        const Eigen::Array2i in = at.cast<int>().max(0).min(cells - 1);
        if (in[0] + cells * in[1] != cell) continue;
        add_pair(split, number, pairs.pixels_px[i], pairs.sigma_of(i));
      }
    }
  }
  return split;
}

}  // namespace vernier::internal
