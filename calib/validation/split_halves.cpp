// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/split_halves.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/shuffled.h"
#include "calib/validation/held_out_boards.h"

namespace vernier::internal {
namespace {

struct ComparedHalves {
  RigDifference honest, mvb;
  std::vector<std::string> names;
  Eigen::VectorXd difference;
};

RigEstimate calibrated(const BoardObservations& observations,
                       std::vector<int> frames,
                       const CalibrationOptions& how) {
  std::sort(frames.begin(), frames.end());
  return calibrate(at_frames(observations, frames), how);
}

/// Nothing if one of the halves does not determine the rig.
std::optional<ComparedHalves> compare_halves(const BoardObservations& observations,
                                             const std::vector<int>& order,
                                             const CalibrationOptions& how) {
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  try {
    const RigEstimate a = calibrated(observations, {order.begin(), middle}, how);
    const RigEstimate b = calibrated(observations, {middle, order.end()}, how);
    const auto compared_by = [&](CovarianceChoice choice) {
      return rig_difference(a.rig, chosen_covariance(a, choice).value(), b.rig,
                            chosen_covariance(b, choice).value());
    };
    return ComparedHalves{compared_by(CovarianceChoice::honest), compared_by(CovarianceChoice::mvb),
                          parameter_names(a.rig), difference(a.rig, b.rig)};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

SplitHalvesResult compare_split_halves(const BoardObservations& observations,
                                       const SplitHalvesOptions& options,
                                       const std::function<void(int done, int total)>& progress) {
  const std::vector<int> frames = frames_of(observations);
  if (frames.size() < fewest_frames_to_divide) {
    throw Error("halves", "needs at least six frames", "give more views");
  }
  if (options.calibration.prior || !options.calibration.known.empty()) {
    throw Error("halves", "both halves share the prior, which hides how far they are apart",
                "calibrate without a prior");
  }
  const auto count = static_cast<std::size_t>(options.splits);
  std::vector<std::optional<ComparedHalves>> compared(count);
  std::mutex mutex;
  int done = 0;
  for_each_index(count, options.threads, [&](std::size_t split) {
    const std::vector<int> order =
        shuffled(frames, {.seed = options.seed,
                          .trial = static_cast<std::uint32_t>(split),
                          .source = static_cast<std::uint32_t>(DrawSource::split_halves)});
    compared[split] = compare_halves(observations, order, options.calibration);
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, options.splits);
  });

  SplitHalvesResult result;
  result.frames = static_cast<int>(frames.size());
  int inside_honest = 0, inside_mvb = 0;
  for (const auto& halves : compared) {
    if (!halves) {
      ++result.failed;
      continue;
    }
    if (++result.splits == 1) {
      result.names = halves->names;
      result.rms_difference = Eigen::VectorXd::Zero(halves->difference.size());
    }
    result.rms_difference += halves->difference.cwiseAbs2();
    result.dof = std::max(result.dof, halves->honest.dof);
    const HalvesDistance distance{halves->honest.mahalanobis2, halves->mvb.mahalanobis2};
    result.distances.push_back(distance);
    result.nees_mean_honest += distance.honest;
    result.nees_mean_mvb += distance.mvb;
    constexpr double level = 0.05;
    inside_honest += halves->honest.p_value >= level;
    inside_mvb += halves->mvb.p_value >= level;
  }
  if (result.splits == 0) {
    throw Error("halves", "no split could be calibrated",
                "give more views, or a model with fewer parameters");
  }
  result.rms_difference = (result.rms_difference / result.splits).cwiseSqrt().eval();
  result.nees_mean_honest /= result.splits;
  result.nees_mean_mvb /= result.splits;
  result.inside_95_honest = static_cast<double>(inside_honest) / result.splits;
  result.inside_95_mvb = static_cast<double>(inside_mvb) / result.splits;
  return result;
}

}  // namespace vernier::internal
