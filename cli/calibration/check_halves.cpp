// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_halves.h"

#include <cstddef>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/validation/split_halves.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

/// Of 60 simulated sets of 14 views, white noise, none is above 1.41; of 60 of 8 views, 1.89; of 60
/// of 7 and of 6, 2.47 and 2.58.
double most_per_dof(int frames) { return frames < 8 ? 3.5 : 2; }

std::string distance_line(const std::string& covariance, double mean, double inside, int dof) {
  return fmt::format("  {:<24} {:>10.1f} {:>10.2f} {:>12.0f} %\n", covariance, mean, mean / dof,
                     100 * inside);
}

}  // namespace

Json halves_json(const SplitHalvesResult& r) {
  return {{"splits", r.splits},
          {"failed", r.failed},
          {"frames", r.frames},
          {"dof", r.dof},
          {"nees_mean_honest", r.nees_mean_honest},
          {"nees_mean_mvb", r.nees_mean_mvb},
          {"inside_95_honest", r.inside_95_honest},
          {"inside_95_mvb", r.inside_95_mvb}};
}

std::vector<std::string> halves_doubts(const SplitHalvesResult& r) {
  const double per_dof = r.nees_mean_honest / r.dof;
  if (per_dof <= most_per_dof(r.frames)) return {};
  return {fmt::format(
      "halves of the views differ by {:.1f} times what their covariances state (squared distance "
      "{:.1f}, {} degrees of freedom); there are too few views, or they are not alike",
      per_dof, r.nees_mean_honest, r.dof)};
}

CheckSection check_halves(const BoardObservations& observations,
                          const SplitHalvesOptions& options,
                          const Session& session) {
  Progress progress(session, "splits");
  const SplitHalvesResult result = compare_split_halves(
      observations, options, [&](int done, int total) { progress.update(done, total); });
  CheckSection part;
  part.json = halves_json(result);
  part.json["seed"] = options.seed;
  for (std::size_t i = 0; i < result.names.size(); ++i) {
    part.json["rms_differences"][result.names[i]] =
        result.rms_difference[static_cast<Eigen::Index>(i)];
  }
  part.text = fmt::format(
      "halves of the {} frames, calibrated apart: {} splits{}, {} degrees of freedom\n"
      "  {:<24} {:>10} {:>10} {:>14}\n",
      result.frames, result.splits,
      result.failed > 0 ? fmt::format(" ({} failed)", result.failed) : "", result.dof,
      "squared distance by the", "mean", "/ dof", "inside 95 %");
  part.text += distance_line("honest covariance", result.nees_mean_honest, result.inside_95_honest,
                             result.dof);
  part.text += distance_line("minimum variance bound", result.nees_mean_mvb, result.inside_95_mvb,
                             result.dof);
  part.failures = halves_doubts(result);
  return part;
}

}  // namespace vernier::cli
