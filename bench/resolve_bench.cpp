// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The re-solver compared with the calibration solver, mrcal and OpenCV: the same corners (100 per
// view, both cameras see every frame), the same model (opencv4, all parameters free), the same
// start, one thread each, each with its own stopping rule. Compare CPU times of one run as ratios;
// scripts/plot_growth.py draws them. Covariances and the fraction of peak performance are measured
// as well.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <map>
#include <opencv2/calib3d.hpp>

#include "bench/counted_operations.h"
#include "bench/fma_peak.h"
#include "bench/plain_problem.h"
#include "calib/base/instruction_set.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/frame_kernel.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/resolve.h"
#include "calib/solver/view_kernel.h"
#include "datasets/shipped.h"

namespace {

using namespace vernier;
using namespace vernier::internal;

struct Scene {
  SimulatedBoard board;
  BoardState start;
  Eigen::Matrix2Xd pixels_px;
};

BoardState start_near(const BoardState& truth) {
  BoardState start = truth;
  for (Camera& camera : start.rig.cameras) {
    camera.parameters[0] *= 1.02;
    camera.parameters[2] += 4;
    camera.parameters[3] -= 3;
    camera.parameters.tail<4>().setZero();
  }
  Eigen::Matrix<double, 6, 1> step;
  step << 3e-3, -2e-3, 4e-3, 2e-3, -1e-3, 1.5e-2;
  for (Pose& T : start.T_first_board) T = retract(T, step);
  start.rig.T_camera_first[1] = retract(start.rig.T_camera_first[1], 0.3 * step);
  return start;
}

const Scene& scene(int frames) {
  static std::map<int, Scene> scenes;
  const auto found = scenes.find(frames);
  if (found != scenes.end()) return found->second;
  Rig rig = datasets::nominal_truth();
  for (Camera& camera : rig.cameras) {
    const double k1 = camera.parameters[4];
    camera.model = OpenCv4{};
    camera.parameters.conservativeResize(8);
    camera.parameters.tail<4>() << k1, 0.03, 4e-4, -3e-4;
  }
  const SimulatedBoardOptions options{.seed = 5, .frames = frames, .distance_m = 0.8};
  Scene made{simulate_board(rig, {10, 10, 0.025}, options), {}, {}};
  made.start = start_near(made.board.truth);
  made.pixels_px.resize(2, 200 * frames);
  Eigen::Index i = 0;
  for (const BoardView& view : made.board.observations.views) {
    for (const auto& q : view.pixels_px) made.pixels_px.col(i++) = q;
  }
  return scenes.emplace(frames, std::move(made)).first->second;
}

const Scene& scene_of(const benchmark::State& state) {
  return scene(static_cast<int>(state.range(0)));
}

/// One solve for new pixels, as in Monte Carlo; the structure is reused.
void resolve(benchmark::State& state) {
  const Scene& s = scene_of(state);
  const Resolver resolver(s.board.observations, s.board.truth);
  ResolveResult result;
  for (auto _ : state) result = resolver.resolve(s.pixels_px, s.start);
  state.counters["linearisations"] = result.iterations;
  state.counters["chi2"] = result.chi2;
  if (result.status != ResolveStatus::converged) state.SkipWithError("did not converge");
}

/// The same, starting from the true values.
void resolve_from_truth(benchmark::State& state) {
  const Scene& s = scene_of(state);
  const Resolver resolver(s.board.observations, s.board.truth);
  ResolveResult result;
  for (auto _ : state) result = resolver.resolve(s.pixels_px);
  state.counters["linearisations"] = result.iterations;
}

void solver_of_record(benchmark::State& state) {
  const Scene& s = scene_of(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(minimise_reprojection(s.board.observations, s.start));
  }
}

void mrcal(benchmark::State& state) {
  if (!mrcal_available()) {
    state.SkipWithError("this build has no libmrcal");
    return;
  }
  const Scene& s = scene_of(state);
  double cost = 0;
  for (auto _ : state) cost = mrcal_optimise_only(s.board.observations, s.start);
  state.counters["chi2"] = cost;
}

void opencv_stereo_calibrate(benchmark::State& state) {
  cv::setNumThreads(1);
  const Scene& s = scene_of(state);
  std::vector<std::vector<cv::Point3f>> target;
  std::vector<std::vector<cv::Point2f>> pixels[2];
  for (const BoardView& view : s.board.observations.views) {
    std::vector<cv::Point2f> q;
    for (const auto& p : view.pixels_px) q.emplace_back(float(p.x()), float(p.y()));
    pixels[view.camera].push_back(q);
    if (view.camera == 1) continue;
    target.emplace_back();
    for (const auto& X : s.board.observations.target_m) {
      target.back().emplace_back(float(X.x()), float(X.y()), float(X.z()));
    }
  }
  for (auto _ : state) {
    cv::Mat K[2], d[2], R(3, 3, CV_64F), T(3, 1, CV_64F), E, F;
    for (int c = 0; c < 2; ++c) {
      const Camera& camera = s.start.rig.cameras[c];
      K[c] = (cv::Mat_<double>(3, 3) << camera.f_px() * camera.ax(), 0, camera.ox_px(), 0,
              camera.f_px(), camera.oy_px(), 0, 0, 1);
      d[c] = cv::Mat::zeros(1, 4, CV_64F);
    }
    const Pose& pose = s.start.rig.T_camera_first[1];
    for (int i = 0; i < 9; ++i) R.at<double>(i / 3, i % 3) = pose.R(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) T.at<double>(i) = pose.t[i];
    cv::Mat errors;
    benchmark::DoNotOptimize(cv::stereoCalibrate(
        target, pixels[0], pixels[1], K[0], d[0], K[1], d[1], {640, 480}, R, T, E, F, errors,
        cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_USE_EXTRINSIC_GUESS | cv::CALIB_FIX_K3,
        {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9}));
  }
}

const BoardState& solved(int frames) {
  static std::map<int, BoardState> states;
  const auto found = states.find(frames);
  if (found != states.end()) return found->second;
  const Scene& s = scene(frames);
  return states.emplace(frames, Resolver(s.board.observations, s.board.truth).resolve().state)
      .first->second;
}

void covariance_by_schur(benchmark::State& state) {
  const Scene& s = scene_of(state);
  const BoardState& at = solved(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    const auto equations = reduced_normal_equations(s.board.observations, at, 1.0);
    benchmark::DoNotOptimize(minimum_variance_bound(equations, parameter_names(at.rig)));
  }
}

void covariance_by_resolver(benchmark::State& state) {
  const Scene& s = scene_of(state);
  const BoardState& at = solved(static_cast<int>(state.range(0)));
  const Resolver resolver(s.board.observations, at);
  for (auto _ : state) benchmark::DoNotOptimize(resolver.covariance(at));
}

void covariance_by_ceres(benchmark::State& state) {
  const Scene& s = scene_of(state);
  PlainProblem problem(s.board.observations, solved(static_cast<int>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(problem.rig_covariance());
}

/// Sums of one linearisation over the corners of eight views, and the fraction of peak performance.
void corner_sums(benchmark::State& state) {
  const Scene& s = scene(8);
  const BoardState& at = s.board.truth;
  const PackedViews views(s.board.observations, at, {});
  const auto pixels = views.pack(s.pixels_px);
  const Eigen::VectorXd intrinsics = kernel_intrinsics(at.rig.cameras[0]);
  Lanes poses[12];
  camera_poses(at, 0, views.groups()[0], poses);
  const ViewLanes lanes =
      views.lanes(views.groups()[0], 0, at, intrinsics.data(), poses[0].of, pixels);
  std::vector<Lanes> sums(packed_size(view_columns(OpenCv4{}, false)));
  for (auto _ : state) {
    sum_views(lanes, sums[0].of);
    benchmark::ClobberMemory();
  }
  const double rows = counted::row_operations<OpenCv4>(),
               products = counted::sum_operations<OpenCv4>();
  const auto corners = static_cast<double>(state.iterations()) * 8 * 100;
  state.counters["row_operations"] = rows;
  state.counters["sum_operations"] = products;
  state.counters["corners"] = benchmark::Counter(corners, benchmark::Counter::kIsRate);
  state.counters["flops"] =
      benchmark::Counter((rows + products) * corners, benchmark::Counter::kIsRate);
  state.SetLabel(std::string(instruction_set()));
}

void fma_peak(benchmark::State& state) {
  double sink = 0, operations = 0;
  for (auto _ : state) operations += static_cast<double>(fma_chains(10000, sink));
  benchmark::DoNotOptimize(sink);
  state.counters["flops"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}

void views(benchmark::internal::Benchmark* bench, int most) {
  for (const int n : {10, 20, 40, 100, 200, 400, 1000, 2000, 4000, 10000}) {
    if (n <= most) bench->Arg(n);
  }
  bench->Unit(benchmark::kMillisecond)->ArgName("stereo_views");
}

BENCHMARK(resolve)->Apply([](auto* b) { views(b, 10000); });
BENCHMARK(resolve_from_truth)->Arg(40)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(solver_of_record)->Apply([](auto* b) { views(b, 10000); });
BENCHMARK(mrcal)->Apply([](auto* b) { views(b, 1000); });
BENCHMARK(opencv_stereo_calibrate)->Apply([](auto* b) { views(b, 100); });
BENCHMARK(covariance_by_schur)->Arg(40)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(covariance_by_resolver)->Arg(40)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(covariance_by_ceres)->Arg(40)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(corner_sums);
BENCHMARK(fma_peak);

}  // namespace
