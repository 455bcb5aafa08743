// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether the default covariance of few views is true: simulated sets with corner noise of several
// kinds, calibrated as `calibrate` does by default.
//
//     few_views [SEED] [SETS]
//
// prints the mean squared Mahalanobis distance of the true rig over the number of parameters, by
// the bound and by the default covariance, the 90 % quantile of the latter, and the share of
// parameters inside their 95 % interval. `motion` moves the board between the exposures of the two
// cameras, which no effect is told. Seeds 11 to 70 chose the method.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/noise/corner_noise.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace {

using namespace vernier;
using namespace vernier::internal;

struct Setup {
  const char* name;
  CornerNoise noise;
  CameraModel model = Radial1{};
  Chessboard board = {8, 5, 0.04};
  bool one_camera = false, has_prior = false;
  std::vector<int> views = {3, 4, 6, 10, 20};
};

/// A prior of focal lengths, principal points and first distortions, its values drawn about the
/// truth.
std::vector<ParameterPrior> drawn_prior(const Rig& truth, RandomStream& draws) {
  struct Width {
    const char* ending;
    double sigma;
  };
  std::vector<ParameterPrior> known;
  const std::vector<std::string> names = parameter_names(truth);
  const Eigen::VectorXd values = parameters(truth);
  for (const Width& width :
       {Width{"f_px", 1}, Width{"ox_px", 2}, Width{"oy_px", 2}, Width{"k1", 0.005}}) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!names[i].ends_with(width.ending)) continue;
      const double value = values[static_cast<Eigen::Index>(i)] + width.sigma * draws.normals(1)[0];
      known.push_back({names[i], value, width.sigma});
    }
  }
  return known;
}

void print_row(const Setup& setup, int views, int sets, std::uint64_t seed) {
  Rig truth = test::stereo_rig(setup.model);
  if (setup.one_camera) {
    truth.cameras.resize(1);
    truth.T_camera_first.resize(1);
  }
  double of_bound = 0, inside = 0;
  std::vector<double> of_default;
  int failed = 0;
  for (int set = 0; set < sets; ++set) {
    const auto number = static_cast<std::uint32_t>(set);
    const SimulatedBoardOptions made{
        .seed = seed, .trial = number, .poses = number, .frames = views, .distance_m = 0.8};
    CalibrationOptions options;
    options.model = setup.model;
    RandomStream draws({.seed = seed, .trial = number, .source = 254});
    if (setup.has_prior) options.known = drawn_prior(truth, draws);
    try {
      const test::NoisyBoard seen = test::noisy_board(truth, setup.board, made, setup.noise);
      const RigEstimate estimate = calibrate(seen.board.observations, options);
      const Eigen::VectorXd error = difference(estimate.rig, truth);
      if (!estimate.covariance || !estimate.covariance_mvb) throw Error("rig", "no covariance", "");
      const Eigen::MatrixXd& P = estimate.covariance->matrix;
      const Eigen::LLT<Eigen::MatrixXd> factor(P);
      if (factor.info() != Eigen::Success) throw Error("covariance", "is not positive", "");
      const auto p = static_cast<double>(error.size());
      of_bound += error.dot(estimate.covariance_mvb->llt().solve(error)) / p;
      of_default.push_back(error.dot(factor.solve(error)) / p);
      const Eigen::ArrayXd sigma = P.diagonal().array().sqrt();
      inside += static_cast<double>((error.array().abs() < 1.96 * sigma).count()) / p;
    } catch (const Error&) {
      ++failed;
    }
  }
  std::sort(of_default.begin(), of_default.end());
  const std::size_t n = of_default.size();
  double sum = 0;
  for (const double value : of_default) sum += value;
  const auto count = static_cast<double>(std::max<std::size_t>(n, 1));
  std::printf("%-30s %5d %5zu %6d %7.2f %8.2f %6.2f %8.1f\n", setup.name, views, n, failed,
              of_bound / count, sum / count, n == 0 ? 0 : of_default[n * 9 / 10],
              100 * inside / count);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 9901;
  const int sets = argc > 2 ? std::atoi(argv[2]) : 80;
  const CornerNoise white{.white_px = 0.15};
  CornerNoise field = white, motion = white;
  field.field_px = 0.1;
  field.field_length_m = 0.06;
  motion.motion_m = 2e-4;
  motion.motion_rad = 8e-4;
  const std::vector<int> two = {4, 8};
  const std::vector<Setup> setups = {
      {"white noise", white},
      {"field", field},
      {"motion", motion},
      {"white noise, prior", white, Radial1{}, {8, 5, 0.04}, false, true, two},
      {"field, prior", field, Radial1{}, {8, 5, 0.04}, false, true, two},
      {"field, opencv4, 12x8 corners", field, OpenCv4{}, {12, 8, 0.03}, false, false, two},
      {"field, one camera", field, Radial1{}, {8, 5, 0.04}, true, false, two}};
  std::printf("%-30s %5s %5s %6s %7s %8s %6s %8s\n", "corner noise", "views", "sets", "failed",
              "bound", "default", "90 %", "inside %");
  try {
    for (const Setup& setup : setups) {
      for (const int views : setup.views) print_row(setup, views, sets, seed);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "few_views: %s\n", error.what());
    return 1;
  }
}
