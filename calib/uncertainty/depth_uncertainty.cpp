// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/triangulation_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/sampled_propagation.h"

namespace vernier {

using namespace internal;

namespace {

void check_pair(const Rig& rig) {
  if (rig.cameras.size() == 2) return;
  throw Error("triangulation", "the rig has " + std::to_string(rig.cameras.size()) + " cameras",
              "give a rig of two");
}

void check_ranges(const std::vector<double>& ranges_m, int samples) {
  for (const double range : ranges_m) {
    if (range > 0 && std::isfinite(range)) continue;
    throw Error("depth uncertainty", "a range of " + std::to_string(range) + " m",
                "give ranges above 0 and finite");
  }
  if (samples < 2) throw Error("depth uncertainty", "fewer than 2 samples", "give more");
}

}  // namespace

std::vector<DepthUncertainty> depth_uncertainty(const RigEstimate& estimate,
                                                const std::vector<double>& ranges_m,
                                                const SamplingOptions& options) {
  const auto [psi_c, samples, seed] = options;
  check_pair(estimate.rig);
  check_ranges(ranges_m, samples);
  const RigSampler sampler(estimate);
  const Rig& rig = estimate.rig;
  const Eigen::MatrixXd& factor = sampler.decomposition().factor();
  std::vector<PixelPair> pairs;
  for (const double range : ranges_m) {
    const Eigen::Vector3d x(0, 0, range);
    pairs.push_back(
        {project(rig.cameras[0], x), project(rig.cameras[1], rig.T_camera_first[1] * x)});
  }
  std::vector<std::vector<double>> depths(pairs.size());  // of the draws; infinite if there is none
  for (int i = 0; i < samples; ++i) {
    const Rig drawn = sampler.sample(psi_c, seed, static_cast<std::uint32_t>(i));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto depth = try_triangulated_depth_m(drawn, pairs[k]);
      depths[k].push_back(depth && *depth > 0 ? *depth : std::numeric_limits<double>::infinity());
    }
  }
  std::vector<DepthUncertainty> result;
  for (std::size_t at = 0; at < pairs.size(); ++at) {
    const double range = ranges_m[at];
    DepthUncertainty u{range, 0, 0, 0, {}};
    // J D U √s column by column: central differences along the principal directions
    constexpr double step = 1e-3;
    for (Eigen::Index k = 0; k < factor.cols(); ++k) {
      const auto depth = [&](double s) {
        return triangulated_depth_m(retract(rig, s * factor.col(k)), pairs[at]);
      };
      u.sigma_linear_m += std::pow(psi_c * (depth(step) - depth(-step)) / (2 * step), 2);
    }
    u.sigma_linear_m = std::sqrt(u.sigma_linear_m);
    double sum = 0, squares = 0;
    int physical = 0;
    for (const double depth : depths[at]) {
      if (!std::isfinite(depth)) continue;
      ++physical;
      sum += depth;
      squares += (depth - range) * (depth - range);
    }
    const double mean = physical > 0 ? sum / physical - range : 0;
    u.sigma_sampled_m =
        physical > 1 ? std::sqrt(std::max(0.0, squares / physical - mean * mean)) : 0;
    u.non_physical_share = 1 - static_cast<double>(physical) / samples;
    std::sort(depths[at].begin(), depths[at].end());
    u.interval_95_m = interval_95(depths[at]);
    result.push_back(u);
  }
  return result;
}

}  // namespace vernier
