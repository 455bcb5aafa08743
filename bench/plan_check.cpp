// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether the number of views that `plan` names is the number that it takes.
//
//     plan_check [RIGS [FIRST_SEED [VIEWS [SHARE]]]]     simulated rigs
//     plan_check --real CALIBRATION.json…        subsets of the views of real calibrations
//
// Simulated: rig, board, its distance and tilt, noise and lens are drawn; VIEWS, else 5 to 8 are
// taken (of a SHARE of frames, so far and later, one camera's view is left out) and calibrated, and
// a target is set, 0.5 to 0.8 of the standard deviation that these give at present. The plan sees
// this calibration only. Then further views of the same kind are taken, one by one, until the
// standard deviation by the true rig, the true poses and the true noise is at the target: the
// number reached. It lies within the plan's interval or not. The rig is calibrated again at the
// number that the plan names, and its error in depth compared with the target.
//
// Real: a random order of the views; the first 5, 8 and 13 are calibrated and planned from. The
// target is the standard deviation that the first 20 of the order have by the rig and the poses of
// the calibration of all views and by the scatter between these; the number reached is the first of
// the order that has it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/planning/views_needed.h"
#include "calib/rig.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/target_quantity.h"

namespace {

using namespace vernier;
using namespace vernier::internal;

constexpr double range_m = 5;
constexpr int all_views = 120;

/// sd by the views' information in this order, after 0, 1, 2 … of them.
std::vector<double> sd_by_number(const TargetQuantity& wanted,
                                 const std::vector<Eigen::MatrixXd>& views,
                                 double noise_px) {
  std::vector<double> sd{std::numeric_limits<double>::infinity()};
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(wanted.gradient.cols(), wanted.gradient.cols());
  for (std::size_t i = 0; i < views.size(); ++i) {
    S += views[i];
    if (i < 2) {
      sd.push_back(sd[0]);
      continue;
    }
    const Eigen::MatrixXd C = solve_symmetric(S, Eigen::MatrixXd(wanted.gradient.transpose()));
    sd.push_back(noise_px * std::sqrt((wanted.gradient * C).trace() /
                                      static_cast<double>(wanted.gradient.rows())));
  }
  return sd;
}

int first_within(const std::vector<double>& sd, double target, int from) {
  for (int n = from; n < static_cast<int>(sd.size()); ++n) {
    if (sd[static_cast<std::size_t>(n)] <= target) return n;
  }
  return static_cast<int>(sd.size());
}

struct Tally {
  int plans = 0, within = 0, narrow = 0, narrow_within = 0, below = 0, above = 0;
  double log_ratio = 0, log_ratio_squares = 0, log_width = 0, stated = 0;

  void add(const ViewsNeeded& needed, int reached) {
    ++plans;
    const bool inside = reached >= needed.interval.low && reached <= needed.interval.high;
    const double width = needed.interval.high / needed.interval.low;
    within += inside;
    narrow += width <= 2;
    narrow_within += inside && width <= 2;
    below += reached < needed.interval.low;
    above += reached > needed.interval.high;
    const double r = std::log(static_cast<double>(reached) / needed.views);
    log_ratio += r;
    log_ratio_squares += r * r;
    log_width += std::log(width);
    stated += needed.confidence;
  }

  void print(const std::string& what) const {
    const double mean = log_ratio / plans;
    std::printf(
        "%-22s plans %3d  within %3d (below %d, above %d)  upper/lower <= 2: %3d, of these within "
        "%3d  reached/median %.2f (sd of log %.2f)  mean width %.2f, stated %.0f %%\n",
        what.c_str(), plans, within, below, above, narrow, narrow_within, std::exp(mean),
        std::sqrt(std::max(0.0, log_ratio_squares / plans - mean * mean)),
        std::exp(log_width / plans), 100 * stated / plans);
  }
};

struct Scene {
  Rig rig;
  Chessboard board;
  SimulatedBoardOptions views;
};

Scene draw_scene(std::uint64_t seed) {
  RandomStream draws({.seed = seed, .source = 200});
  Scene scene;
  const bool rich = draws.uniform() < 0.5;
  const double f_px = draws.uniform(400, 900), baseline_m = draws.uniform(0.08, 0.3);
  std::vector<PlacedCamera> cameras(2);
  for (std::size_t c = 0; c < 2; ++c) {
    Camera& camera = cameras[c].camera;
    camera.size_px = {640, 480};
    camera.model = Radial1{};
    camera.parameters = Eigen::VectorXd(5);
    camera.parameters << f_px * draws.uniform(0.99, 1.01), 1 + draws.uniform(-2e-3, 2e-3),
        320 + draws.uniform(-12, 12), 240 + draws.uniform(-12, 12), draws.uniform(-0.25, 0);
  }
  cameras[1].T_camera_reference.R = rotation_from_vector(
      {draws.uniform(-0.02, 0.02), draws.uniform(-0.04, 0.04), draws.uniform(-0.02, 0.02)});
  cameras[1].T_camera_reference.t = {-baseline_m, draws.uniform(-2e-3, 2e-3),
                                     draws.uniform(-2e-3, 2e-3)};
  scene.rig = rig_of(cameras);
  if (rich) scene.rig = in_models(scene.rig, {OpenCv4{}, OpenCv4{}});
  scene.board = {draws.uniform() < 0.5 ? 9 : 7, 6, draws.uniform(0.02, 0.035)};
  scene.views.seed = seed;
  scene.views.frames = all_views;
  scene.views.pixel_sigma_px = draws.uniform(0.08, 0.4);
  scene.views.distance_m = draws.uniform(0.5, 1.1) * f_px / 500;
  scene.views.tilt_rad = draws.uniform(0.4, 0.8);
  return scene;
}

struct Tallies {
  Tally depth, projection;
  int failed = 0;
  std::vector<double> errors_in_targets;
};

/// Without one of the two views in `share` of the frames, each camera's alike.
BoardObservations partly_seen(BoardObservations all, double share, std::uint64_t seed) {
  std::erase_if(all.views, [&](const BoardView& view) {
    RandomStream draws(
        {.seed = seed, .feature = static_cast<std::uint32_t>(view.frame), .source = 202});
    const bool alone = draws.uniform() < share;
    return alone && static_cast<std::uint32_t>(view.camera) == draws.below(2);
  });
  return all;
}

void try_simulated(std::uint64_t seed, int views, double share_alone, Tallies& tallies) {
  const Scene scene = draw_scene(seed);
  RandomStream draws({.seed = seed, .source = 201});
  if (views == 0) views = 5 + static_cast<int>(draws.below(4));
  const double share = draws.uniform(0.5, 0.8);
  RigEstimate so_far;
  SimulatedBoard all;
  ViewKnowledge known;
  std::vector<int> frames;
  for (int i = 0; i < views; ++i) frames.push_back(i);
  try {
    all = simulate_board(scene.rig, scene.board, scene.views);
    all.observations = partly_seen(all.observations, share_alone, seed);
    so_far = calibrate(at_frames(all.observations, frames), {.models = models_of(scene.rig)});
    known = knowledge_of(so_far, seed, "so far");
  } catch (const Error& error) {
    std::printf("rig %llu: %s: %s\n", static_cast<unsigned long long>(seed), error.place().c_str(),
                error.fault().c_str());
    ++tallies.failed;
    return;
  }
  const auto truth = reduced_normal_equations(all.observations, all.truth, 1);
  for (const std::string what : {"depth", "projection"}) {
    const auto sd = sd_by_number(target_quantity(scene.rig, what, range_m), truth.frame_information,
                                 scene.views.pixel_sigma_px);
    const double target = share * sd_after(known, what, range_m, {views})[0].sd;
    const ViewsNeeded needed = views_needed(known, what, range_m, target);
    const int reached = first_within(sd, target, views);
    (what == std::string("depth") ? tallies.depth : tallies.projection).add(needed, reached);
    std::printf(
        "rig %llu %s: %d views of %s, %.2f px; target %.3g; plan %d [%.0f, %.0f], reached %d\n",
        static_cast<unsigned long long>(seed), what.c_str(), views,
        std::string(model_name(scene.rig.cameras[0].model)).c_str(), scene.views.pixel_sigma_px,
        target, needed.views, needed.interval.low, needed.interval.high, reached);
    if (what != std::string("depth") || needed.views > all_views) continue;
    frames.clear();
    for (int i = 0; i < needed.views; ++i) frames.push_back(i);
    const RigEstimate then =
        calibrate(at_frames(all.observations, frames), {.models = models_of(scene.rig)});
    const auto pair = pixel_pair(scene.rig, {0, 0, range_m});
    tallies.errors_in_targets.push_back((triangulated_depth_m(then.rig, *pair) - range_m) / target);
  }
}

void simulated(int rigs, std::uint64_t first_seed, int views, double share_alone) {
  Tallies tallies;
  for (int r = 0; r < rigs; ++r) {
    try_simulated(first_seed + static_cast<std::uint64_t>(r), views, share_alone, tallies);
  }
  tallies.depth.print(fmt::format("depth at {} m", range_m));
  tallies.projection.print(fmt::format("projection at {} m", range_m));
  double squares = 0;
  for (const double e : tallies.errors_in_targets) squares += e * e;
  const auto n = static_cast<double>(tallies.errors_in_targets.size());
  std::printf(
      "calibrations that failed: %d; rms error in depth at the planned number over target: "
      "%.2f +- %.2f (%.0f rigs)\n",
      tallies.failed, std::sqrt(squares / n), std::sqrt(squares / n / (2 * n)), n);
}

void real(const std::string& file) {
  const RigEstimate whole = read_rig(file).estimate;
  const CalibrationEvidence& evidence = *whole.evidence;
  const ViewKnowledge of_all = knowledge_of(whole, 1, file);
  const auto equations = reduced_normal_equations(
      evidence.observations,
      BoardState{whole.rig, evidence.frames, evidence.T_first_board, evidence.warp_m}, 1);
  const auto count = static_cast<int>(evidence.frames.size());
  const int goal = std::min(20, count);
  std::printf("%s: %d views, noise %.3f px, inflation %.2f\n", file.c_str(), count, of_all.noise_px,
              of_all.inflation);
  constexpr int orders = 20;
  for (const int views : {5, 8, 13}) {
    if (views >= goal) continue;
    Tally depth, projection;
    int failed = 0;
    for (int order = 0; order < orders; ++order) {
      std::vector<int> at(static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i) at[static_cast<std::size_t>(i)] = i;
      RandomStream draws({.seed = 77, .trial = static_cast<std::uint32_t>(order), .source = 202});
      for (int i = 0; i < count - 1; ++i) {
        std::swap(
            at[static_cast<std::size_t>(i)],
            at[static_cast<std::size_t>(i) + draws.below(static_cast<std::uint32_t>(count - i))]);
      }
      std::vector<Eigen::MatrixXd> information;
      std::vector<int> first;
      for (int i = 0; i < count; ++i) {
        const int index = at[static_cast<std::size_t>(i)];
        information.push_back(equations.frame_information[static_cast<std::size_t>(index)]);
        if (i < views) first.push_back(evidence.frames[static_cast<std::size_t>(index)]);
      }
      std::sort(first.begin(), first.end());
      try {
        const RigEstimate so_far =
            calibrate(at_frames(evidence.observations, first), {.models = models_of(whole.rig)});
        const ViewKnowledge known = knowledge_of(so_far, 1, file);
        for (const std::string what : {"depth", "projection"}) {
          const TargetQuantity wanted = target_quantity(whole.rig, what, range_m);
          const auto sd = sd_by_number(wanted, information, of_all.noise_px);
          const double at_goal = sd[static_cast<std::size_t>(goal)];
          const double target =
              at_goal * sd_of(wanted, of_all.by_scatter.contributions) / sd.back();
          const ViewsNeeded needed = views_needed(known, what, range_m, target);
          (what == std::string("depth") ? depth : projection)
              .add(needed, first_within(sd, at_goal, views));
        }
      } catch (const Error& error) {
        ++failed;
      }
    }
    if (depth.plans == 0) continue;
    depth.print(fmt::format("depth, {} of {}", views, goal));
    projection.print(fmt::format("projection, {} of {}", views, goal));
    if (failed > 0) std::printf("  %d calibrations failed\n", failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--real") {
    for (std::size_t i = 1; i < words.size(); ++i) real(words[i]);
    return 0;
  }
  const auto number = [&](std::size_t i, int otherwise) {
    return i < words.size() ? std::atoi(words[i].c_str()) : otherwise;
  };
  simulated(number(0, 100), static_cast<std::uint64_t>(number(1, 5001)), number(2, 0),
            words.size() > 3 ? std::atof(words[3].c_str()) : 0);
}
