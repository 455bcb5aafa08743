// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/board_target.h"
#include "calib/calibration/solve_again.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/planning/views_needed.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/target_quantity.h"
#include "cli/program/chosen_cameras.h"
#include "cli/program/limited_grid.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/plan_doubts.h"
#include "cli/simulation/plan_result.h"
#include "cli/simulation/plan_success.h"
#include "sim/study/study.h"

namespace vernier::cli {
namespace {

constexpr int most_plan_corners = 10'000;  ///< of a board

struct PlanArguments {
  std::string rig, cameras, depth, projection, board;
  double success = 0, at_m = 5, square_m = 0.025, pixel_sigma_px = 0.2, pair_sigma_px = 0;
  double board_distance_m = 1, board_tilt_deg = 34;
  SuccessTrials trials;  ///< of --success
  std::uint64_t seed = 1;
  const CLI::App* app = nullptr;
};

/// "0.02", or "0.02@5m": the number, and the distance if there is one.
double number_at(const std::string& text, const std::string& option, double& at_m) {
  const std::size_t at = text.find('@');
  std::string range = at == std::string::npos ? "" : text.substr(at + 1);
  if (range.ends_with("m")) range.pop_back();
  const auto number = [&](const std::string& word) {
    const auto found = to_finite(word);
    if (found && *found > 0) return *found;
    throw Error(option, in_quotes(text) + " is not such as 0.02 or 0.02@5m, in metres",
                "give a number above 0, and after an @ the distance");
  };
  if (at != std::string::npos) at_m = number(range);
  return number(text.substr(0, at));
}

/// Throws Error for options that would have no effect.
void refuse_unused_options(const CLI::App& app, const PlanTarget& target, bool from_calibration) {
  if (target.quantity != "success") {
    refuse_options(
        app, std::array{"--study", "--world", "--protocol", "--method", "--within-m", "--trials"},
        "only valid with --success", "leave it out");
  }
  if (target.quantity != "depth") {
    refuse_options(app, std::array{"--pair-sigma-px"}, "only valid with --depth-error",
                   "leave it out");
  }
  if (from_calibration) {
    refuse_options(
        app, std::array{"--square-m", "--board-distance-m", "--board-tilt-deg", "--pixel-sigma"},
        "the calibration's own views say this", "leave it out, or give --board for a datasheet");
  }
}

PlanTarget target_of(const PlanArguments& o) {
  const int given = !o.depth.empty() + !o.projection.empty() + (o.success > 0);
  if (given != 1) {
    throw Error("plan", given == 0 ? "no target given" : "more than one target given",
                "give one of --depth-error, --projection-error and --success");
  }
  PlanTarget target;
  target.at_m = o.at_m;
  if ((o.depth + o.projection).find('@') != std::string::npos) {
    refuse_options(*o.app, std::array{"--at-m"}, "the target gives a distance after its @");
  }
  if (!o.depth.empty()) {
    target.quantity = "depth";
    target.unit = "m";
    target.value = number_at(o.depth, "--depth-error", target.at_m);
  } else if (!o.projection.empty()) {
    target.quantity = "projection";
    target.unit = "px";
    target.value = number_at(o.projection, "--projection-error", target.at_m);
  } else {
    target.quantity = "success";
    target.value = o.success;
  }
  return target;
}

/// What is known of the cameras: by the rig's board views, or by a datasheet and a board.
void know(const PlanArguments& o,
          const RigEstimate& rig,
          const std::vector<int>& cameras,
          const std::string& name,
          PlanResult& plan) {
  const std::string chosen = o.cameras.empty() ? "" : ", for the cameras " + o.cameras;
  const bool has_views = rig.evidence && !rig.evidence->observations.views.empty();
  plan.from_calibration = has_views && o.board.empty();
  plan.leaves_views_out = has_views && !o.board.empty();
  if (plan.from_calibration) {
    plan.known =
        with_errors_of(name, [&] { return knowledge_of(without_effects(rig), o.seed, name); });
    if (!o.cameras.empty()) plan.known = for_cameras(plan.known, cameras);
    const bool effects = rig.calibration && rig.calibration->effects;
    plan.basis = fmt::format("the calibration {}{} and further views of the same kind{}{}", name,
                             effects ? " (without the board's shape and motion)" : "", chosen,
                             partial_frames_text(plan.known));
    return;
  }
  const std::string words = o.board.empty() ? "9x6" : o.board;
  const auto [columns, rows] = parse_limited_grid(words, "--board", most_plan_corners);
  const SimulatedBoardOptions views{.seed = o.seed,
                                    .pixel_sigma_px = o.pixel_sigma_px,
                                    .distance_m = o.board_distance_m,
                                    .tilt_rad = o.board_tilt_deg * (std::numbers::pi / 180)};
  plan.known = knowledge_of_datasheet(o.cameras.empty() ? rig : part_of(rig, cameras),
                                      {columns, rows, o.square_m}, views, name);
  plan.basis = fmt::format(
      "the datasheet {} and a {} board, squares of {:g} m, at {:g} m, tilted up to {:g} degrees{}",
      name, words, o.square_m, o.board_distance_m, o.board_tilt_deg, chosen);
}

/// Standard deviation of the depth of one match by pixel noise alone; not a number if the rig is no
/// pair that sees such a point.
double pixel_noise_sd(const Rig& rig, double at_m, double pair_sigma_px) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (rig.cameras.size() != 2) return nan;
  const auto pair = pixel_pair(rig, {0, 0, at_m});
  if (!pair) return nan;
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(parameter_count(rig), parameter_count(rig));
  const auto point = TriangulationUncertainty(rig, none).at(*pair, pair_sigma_px);
  return point ? std::sqrt(point->observation(2, 2)) : nan;
}

/// The part of the target that the calibration may have.
void allow_for_pixel_noise(const PlanArguments& o, PlanResult& plan) {
  const PlanTarget& target = plan.target;
  const Rig& rig = plan.known.pools[0].rig;
  plan.pair_sigma_px = target.quantity == "depth" ? o.pair_sigma_px : 0;
  const double noise_px = plan.pair_sigma_px > 0 ? plan.pair_sigma_px : plan.known.residual_px();
  plan.pixel_noise_sd = pixel_noise_sd(rig, target.at_m, noise_px);
  if (!(plan.pair_sigma_px > 0)) {
    plan.sd_allowed = target.value;
    return;
  }
  const double noise = plan.pixel_noise_sd;
  if (target.value > noise) {
    plan.sd_allowed = std::sqrt(target.value * target.value - noise * noise);
    return;
  }
  plan.limit = fmt::format(
      "pixel noise of {:g} px alone gives {:.3g} m; what limits is the match and the geometry, not "
      "the calibration: a baseline, or a focal length in pixels, {:.2g} times as large, or noise "
      "as "
      "much smaller, would bring it to the target",
      plan.pair_sigma_px, noise, noise / target.value);
}

void run(const PlanArguments& o, Session& session) {
  PlanResult plan;
  plan.target = target_of(o);
  std::optional<Study> study;
  if (plan.target.quantity == "success") study = study_of(o.trials, o.seed, *o.app, session);
  const bool has_rig_of_study = o.rig.empty() && !o.trials.study.empty();
  const std::string name = has_rig_of_study ? study->file.rig : o.rig.empty() ? "nominal" : o.rig;
  const RigFile file = read_rig(
      has_rig_of_study ? find_rig(name, std::filesystem::path(o.trials.study).parent_path())
                       : find_rig(name));
  for (const std::string& warning : file.warnings) session.warn(warning);
  const std::vector<int> cameras = chosen_cameras(file.estimate.rig, o.cameras);
  if (plan.target.quantity != "projection") require_chosen_pair(file.estimate.rig, o.cameras, name);
  know(o, file.estimate, cameras, name, plan);
  refuse_unused_options(*o.app, plan.target, plan.from_calibration);
  if (study) {
    allow_for_success(std::move(*study), o.trials.threads, plan, session);
  } else {
    allow_for_pixel_noise(o, plan);
  }
  const std::string what = plan.target.quantity == "projection" ? "projection" : "depth";
  const ViewPlanOptions how{.seed = o.seed};
  with_errors_of(name, [&] {
    if (plan.sd_allowed) {
      const auto needed_of = [&](const ViewKnowledge& known) {
        return plan.scale ? views_for_success(plan, known, how)
                          : views_needed(known, what, plan.target.at_m, *plan.sd_allowed, how);
      };
      plan.needed = needed_of(plan.known);
      const auto better =
          has_partial_frames(plan.known) ? with_views_by_all(plan.known) : std::nullopt;
      if (better) plan.needed_by_all = needed_of(*better);
      if (plan.limit.empty() && !plan.needed->is_reached) {
        plan.limit =
            fmt::format("it takes more than {} of this kind; ", counted(how.most_views, "view"));
        plan.limit +=
            plan.needed_by_all && plan.needed_by_all->is_reached
                ? "what limits is how few of them all cameras see: " +
                      by_all_text(*plan.needed_by_all)
                : "what limits is each view: more corners, larger tilts, a closer board or less "
                  "noise";
      }
    }
    std::vector<int> numbers;
    for (const int n : {5, 8, 10, 15, 20, 30, 50, 100}) {
      if (n > plan.known.taken) numbers.push_back(n);
    }
    if (plan.known.taken > 0) numbers.insert(numbers.begin(), plan.known.taken);
    plan.curve = sd_after(plan.known, what, plan.target.at_m, numbers, how);
    if (plan.from_calibration && o.cameras.empty() && file.estimate.covariance) {
      plan.stated_sd = sd_of(target_quantity(file.estimate.rig, what, plan.target.at_m),
                             ScaledDecomposition(*file.estimate.covariance).factor());
    }
    return 0;
  });
  if (o.board.empty()) warn_of_lost_views(file.estimate, name, session);
  warn_of_doubtful_plan(plan, session);
  session.result(plan_json(plan), plan_text(plan));
}

}  // namespace

void add_plan(CLI::App& app, Session& session) {
  auto o = std::make_shared<PlanArguments>();
  CLI::App* verb = add_verb(
      app, session, "plan",
      "how many board views a wanted accuracy takes, from a calibration so far or a datasheet",
      "vernier plan rig.json --depth-error 0.02@5m\n"
      "  vernier plan datasheet.json --board 9x6 --square-m 0.025 --projection-error 0.5@2m\n"
      "  vernier plan rig.json --success 0.95 --world workshop --within-m 0.1\n"
      "  vernier plan rig.json --success 0.95 --study study.toml");
  o->app = verb;
  verb->add_option("rig,--rig", o->rig,
                   "calibration with its board views, or a datasheet (default: nominal)");
  verb->add_option("--cameras", o->cameras,
                   "the cameras to plan for, as left,right (default: all; --depth-error and "
                   "--success need two)");
  verb->add_option("--depth-error,--target-depth-sigma-m", o->depth,
                   "wanted standard deviation of the depth, metres, as 0.02 or 0.02@5m");
  verb->add_option("--projection-error,--target-projection-sigma-px", o->projection,
                   "wanted standard deviation of the projection, pixels, as 0.5 or 0.5@2m");
  verb->add_option("--success,--target-success", o->success,
                   "wanted success rate of localisation, or of what --study tries")
      ->check([](const std::string& text) {
        const double rate = to_finite(text).value_or(0);
        return rate >= 1e-3 && rate <= 0.9999
                   ? std::string()
                   : in_quotes(text) + " is not from 0.001 to 0.9999, such as 0.95 for 95 %";
      });
  verb->add_option("--at-m", o->at_m, "distance, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--pair-sigma-px", o->pair_sigma_px,
                   "noise of a match in each image, part of the wanted depth error (0: it is that "
                   "of the calibration alone)")
      ->check(finite_and_not_negative)
      ->capture_default_str();
  verb->add_option("--board", o->board,
                   "plan from a datasheet: inner corners of the board, such as 9x6");
  verb->add_option("--square-m", o->square_m, "its squares, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--board-distance-m", o->board_distance_m,
                   "its distance, varied by a third either way, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--board-tilt-deg", o->board_tilt_deg, "its largest tilt about x and y")
      ->check(CLI::Range(1.0, 80.0))
      ->capture_default_str();
  verb->add_option("--pixel-sigma", o->pixel_sigma_px, "noise of its corners, pixels")
      ->check(finite_and_positive)
      ->capture_default_str();
  add_success_options(*verb, o->trials);
  verb->add_option("--seed", o->seed,
                   "seed of all draws; with --study its own is that of the trials")
      ->capture_default_str();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
