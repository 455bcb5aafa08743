// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibration from matched pairs: one pass over the pairs and a complete solution, compared with
// Ceres and the same residual by automatic differentiation. CPU time, one thread.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "calib/camera.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/resolve_pairs.h"
#include "tests/support/jet_oracles.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

RigPrior prior_of(const Rig& mean) {
  return {mean, Eigen::MatrixXd(test::datasheet_sd().cwiseAbs2().cwiseInverse().asDiagonal())};
}

/// Displaced by half a standard deviation of the prior in every parameter, with alternating signs.
Rig start_of(const Rig& truth) {
  Eigen::VectorXd away = 0.5 * test::datasheet_sd();
  for (Eigen::Index i = 0; i < away.size(); i += 2) away[i] = -away[i];
  return retract(truth, away);
}

PairObservations pairs_of(int count) {
  return simulate_pairs(test::stereo_rig(), 1, 0,
                        {.image_pairs = 20, .pairs_per_image = count / 20});
}

void resolve_pairs(benchmark::State& state) {
  const PairResolver resolver(pairs_of(static_cast<int>(state.range(0))));
  const RigPrior prior = prior_of(start_of(test::stereo_rig()));
  int iterations = 0;
  for (auto _ : state) {
    const EpipolarMinimum minimum = resolver.minimise(prior.mean, {.priors = {prior}});
    iterations = minimum.iterations;
    benchmark::DoNotOptimize(minimum.cost);
  }
  state.counters["iterations"] = iterations;
}
BENCHMARK(resolve_pairs)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);

void ceres_pairs(benchmark::State& state) {
  const PairObservations pairs = pairs_of(static_cast<int>(state.range(0)));
  const RigPrior prior = prior_of(start_of(test::stereo_rig()));
  for (auto _ : state) {
    benchmark::DoNotOptimize(test::solve_by_jets(pairs, prior, prior.mean));
  }
}
BENCHMARK(ceres_pairs)->Arg(2000)->Unit(benchmark::kMillisecond);

void one_pass(benchmark::State& state) {
  const PackedPairs packed(pairs_of(static_cast<int>(state.range(0))));
  const Rig rig = start_of(test::stereo_rig(camera_model(state.range(1) ? "opencv5" : "radial1")));
  for (auto _ : state) benchmark::DoNotOptimize(epipolar_sums(packed, rig, {}).cost);
  state.counters["ns_a_pair"] =
      benchmark::Counter(1e-9 * static_cast<double>(state.iterations() * state.range(0)),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(one_pass)->Args({2000, 0})->Args({1000000, 0})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vernier
