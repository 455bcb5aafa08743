// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/covariance.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

void run_rig_json(std::string_view bytes) {
  const auto file = accepted([&] { return parse_rig(std::string(bytes), "rig.json"); });
  if (!file) return;
  accepted([&] { return gaussian_rig_prior(*file, "rig.json"); });
  const auto text = accepted([&] { return format_rig(file->estimate); });
  if (!text) return;
  const RigFile again = parse_rig(*text, "written");
  require_same(file->estimate, again.estimate);
  require(format_rig(file->estimate, KeepEvidence::no).size() <= text->size(),
          "a file without evidence is not longer");
}

/// A rig with all that a calibration leaves in its file.
RigEstimate calibrated_rig() {
  RigEstimate estimate;
  estimate.rig = example_rig("pinhole", 2);
  const SimulatedBoard board =
      simulate_board(estimate.rig, {3, 3, 0.1}, {.seed = 1, .frames = 3, .distance_m = 0.8});
  const Eigen::Index n = parameter_count(estimate.rig);
  const Eigen::VectorXd sigma = Eigen::VectorXd::LinSpaced(n, 0.01, 0.3);
  Eigen::MatrixXd C = 0.1 * sigma * sigma.transpose();
  C.diagonal() += sigma.cwiseAbs2();
  estimate.covariance = Covariance{CovarianceKind::jackknife, parameter_names(estimate.rig), C};
  estimate.covariance_mvb = C / 2;
  estimate.calibration = CalibrationSummary{};
  estimate.calibration->source = "combined";
  estimate.calibration->pixel_sigma_px = estimate.calibration->rms_px = 0.2;
  estimate.calibration->chi2 = 90.5;
  estimate.calibration->dof = 40;
  estimate.calibration->views = 4;
  estimate.calibration->prior_chi2 = 1.5;
  estimate.calibration->prior_dof = 16;
  estimate.calibration->outliers.push_back({0, 1, 2, "right00.png", {3, 4}, 5.5});
  estimate.calibration->pair_outliers.push_back({0, 1, {200, 60, 180, 60.5}, 3});
  estimate.calibration->board_aspect = AspectEstimate{-0.002, 0.0004};
  estimate.calibration->warnings = {"a warning"};
  estimate.calibration->trust_warnings = {"a doubt"};
  CalibrationEvidence& evidence = estimate.evidence.emplace();
  evidence.observations = board.observations;
  evidence.frames = frames_of(board.observations);
  evidence.T_first_board = board.truth.T_first_board;
  evidence.warp_m = {0.001, -0.002};
  add_pair(evidence.pairs, 0, {100, 50, 80, 50.5}, 0.25);
  add_pair(evidence.pairs, 0, {200, 60, 180, 60.5}, 0.5);
  evidence.priors.push_back({estimate.rig, *estimate.covariance});
  return estimate;
}

std::vector<std::string> rig_json_seeds() {
  std::vector<std::string> seeds;
  for (const char* model : {"pinhole", "radial1", "opencv8", "fisheye4"}) {
    RigEstimate estimate;
    estimate.rig = example_rig(model, 2);
    seeds.push_back(format_rig(estimate));
  }
  RigEstimate estimate = calibrated_rig();
  seeds.push_back(format_rig(estimate));
  seeds.push_back(format_rig(estimate, KeepEvidence::no));
  estimate.calibration->effects = {
      0.1, 0.05, 0.06, 1e-3, 3e-4, 4e-4, 5e-5, 2e-4, {{0, 1e-4, -2e-4}}};
  seeds.push_back(format_rig(estimate, KeepEvidence::no));
  estimate.calibration->effects.reset();
  // A component of the rotation that was held: the others are listed.
  const Eigen::Index held = pose_index(estimate.rig, 1) + 1;
  for (Eigen::MatrixXd* C : {&estimate.covariance->matrix, &*estimate.covariance_mvb}) {
    C->row(held).setZero();
    C->col(held).setZero();
  }
  estimate.calibration->held = {parameter_names(estimate.rig)[static_cast<std::size_t>(held)]};
  estimate.evidence.reset();
  seeds.push_back(format_rig(estimate));
  return seeds;
}

const Registered registered_rig_json{
    {"rig_json", 20'000, "rig_json", run_rig_json, rig_json_seeds}};

}  // namespace
}  // namespace vernier::fuzz
