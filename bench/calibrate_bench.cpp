// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The calibration solver and OpenCV's on the same corners, one thread each.
#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/lens_models.h"
#include "calib/simulated_board.h"
#include "datasets/shipped.h"

namespace {

using namespace vernier;

const SimulatedBoard& board(int frames) {
  static std::map<int, SimulatedBoard> boards;
  auto found = boards.find(frames);
  if (found == boards.end()) {
    const SimulatedBoardOptions options{.seed = 5, .frames = frames, .distance_m = 0.8};
    found =
        boards.emplace(frames, simulate_board(datasets::nominal_truth(), {10, 10, 0.025}, options))
            .first;
  }
  return found->second;
}

void vernier_calibrate(benchmark::State& state) {
  const auto& observations = board(static_cast<int>(state.range(0))).observations;
  for (auto _ : state) benchmark::DoNotOptimize(calibrate(observations, {.model = OpenCv5{}}));
}

void opencv_stereo_calibrate(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto& observations = board(static_cast<int>(state.range(0))).observations;
  std::vector<std::vector<cv::Point3f>> target;
  std::vector<std::vector<cv::Point2f>> pixels[2];
  for (const BoardView& view : observations.views) {
    std::vector<cv::Point2f> q;
    for (const auto& p : view.pixels_px) q.emplace_back(float(p.x()), float(p.y()));
    pixels[view.camera].push_back(q);
    if (view.camera == 1) continue;
    target.emplace_back();
    for (const auto& X : observations.target_m) {
      target.back().emplace_back(float(X.x()), float(X.y()), float(X.z()));
    }
  }
  for (auto _ : state) {
    cv::Mat K1 = cv::initCameraMatrix2D(target, pixels[0], {640, 480}, 1);
    cv::Mat K2 = cv::initCameraMatrix2D(target, pixels[1], {640, 480}, 1);
    cv::Mat d1, d2, R, T, E, F;
    benchmark::DoNotOptimize(
        cv::stereoCalibrate(target, pixels[0], pixels[1], K1, d1, K2, d2, {640, 480}, R, T, E, F,
                            cv::CALIB_USE_INTRINSIC_GUESS,
                            {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9}));
  }
}

BENCHMARK(vernier_calibrate)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);
BENCHMARK(opencv_stereo_calibrate)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

}  // namespace
