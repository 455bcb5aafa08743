// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Projection uncertainty over a 60x45 grid: starting from the evidence, with the same steps as
// mrcal's function (linearisation of all residuals, covariance, grid), and starting from the
// prepared object. The rig is read from the file in VERNIER_BENCH_RIG, which
// bench/projection_vs_mrcal.py sets for the comparison; default: a simulated calibration.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <limits>

#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/lens_models.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "datasets/shipped.h"

namespace {

using namespace vernier;
using namespace vernier::internal;

const RigEstimate& estimate() {
  static const RigEstimate estimate = [] {
    if (const char* file = std::getenv("VERNIER_BENCH_RIG")) return read_rig(file).estimate;
    const SimulatedBoardOptions options{.seed = 5, .frames = 40, .distance_m = 0.8};
    const auto board = simulate_board(datasets::nominal_truth(), {10, 10, 0.025}, options);
    return calibrate(board.observations, {.model = OpenCv4{}});
  }();
  return estimate;
}

void grid_from_evidence(benchmark::State& state) {
  estimate();
  const double distance_m =
      state.range(0) > 0 ? double(state.range(0)) : std::numeric_limits<double>::infinity();
  const CalibrationEvidence& evidence = *estimate().evidence;
  const BoardState solved{estimate().rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const auto names = parameter_names(estimate().rig);
  for (auto _ : state) {
    RigAndBoards joint = rig_and_boards(estimate(), CovarianceChoice::mvb);
    joint.rig_covariance = minimum_variance_bound(
        reduced_normal_equations(evidence.observations, solved, joint.board_sigma_px), names);
    const ProjectionUncertainty u(joint, 1, PointFixedTo::boards);
    benchmark::DoNotOptimize(projection_grid(u, {.distance_m = distance_m}));
  }
}

void grid_prepared(benchmark::State& state) {
  const ProjectionUncertainty u(rig_and_boards(estimate(), CovarianceChoice::mvb), 1,
                                PointFixedTo::boards);
  for (auto _ : state) benchmark::DoNotOptimize(projection_grid(u));
}

void sampled_points(benchmark::State& state) {
  const RigSampler sampler(estimate());
  const auto boards = rig_and_boards(estimate(), CovarianceChoice::honest);
  const std::vector<FixedPoint> points(5, {{0.1, 0.1, 1}, false});
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        sampled_projection(sampler, boards, 1, PointFixedTo::boards, points, {.samples = 1000}));
  }
}

BENCHMARK(grid_from_evidence)->ArgName("distance_m")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond);
BENCHMARK(grid_prepared)->Unit(benchmark::kMillisecond);
BENCHMARK(sampled_points)->Unit(benchmark::kMillisecond);

}  // namespace
