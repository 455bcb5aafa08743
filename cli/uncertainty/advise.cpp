// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/board/board_placement.h"
#include "calib/board_target.h"
#include "calib/calibration/solve_again.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/uncertainty/next_view.h"
#include "calib/uncertainty/target_quantity.h"
#include "cli/program/chosen_cameras.h"
#include "cli/program/limited_grid.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {
namespace {

constexpr int most_board_corners = 10'000;  ///< of a board

struct AdviseArguments {
  std::string rig, cameras, reduce = "depth", board, covariance = "mvb";
  double at_m = 5, square_m = 0, pixel_sigma_px = 0;
  int views = 1, more = 10;
  bool partly = false;
};

/// The covariance used for planning, and the scale from its standard deviations to the reported
/// ones.
struct Basis {
  Eigen::MatrixXd factor;     ///< of the planning covariance
  double pixel_sigma_px = 0;  ///< corner noise of a new view
  double scale = 1;           ///< reported sd divided by that of `factor`
  CovarianceKind planned_on, stated;
  double bound_ratio = 1;  ///< honest sd of the target error divided by the bound's
};

TargetQuantity wanted_of(const AdviseArguments& options,
                         const Rig& rig,
                         const std::vector<int>& cameras) {
  const std::string& what = options.reduce;
  if (what == "depth" || what == "rectification" || what == "baseline") {
    require_chosen_pair(rig, options.cameras, what);
  }
  return options.cameras.empty() ? target_quantity(rig, what, options.at_m)
                                 : target_quantity(rig, cameras, what, options.at_m);
}

std::string find_target(const AdviseArguments& options,
                        const RigEstimate& rig,
                        std::vector<Eigen::Vector3d>& target_m,
                        Eigen::Vector2d& warp_m) {
  if (!options.board.empty() || options.square_m > 0) {
    if (options.board.empty() || !(options.square_m > 0)) {
      throw Error("advise", "--board and --square-m must be given together", "give both");
    }
    const auto [columns, rows] = parse_limited_grid(options.board, "--board", most_board_corners);
    target_m = target_points(Chessboard{columns, rows, options.square_m});
    return fmt::format("{}x{} corners, squares of {} m", columns, rows, options.square_m);
  }
  if (!rig.evidence || rig.evidence->observations.views.empty()) {
    throw Error(options.rig, "the file has no board views, so the board is unknown",
                "give --board (inner corners, such as 9x6) and --square-m");
  }
  target_m = rig.evidence->observations.target_m;
  warp_m = rig.evidence->warp_m;
  return fmt::format("board of the calibration, {} corners", target_m.size());
}

Basis find_basis(const AdviseArguments& options,
                 const RigEstimate& rig,
                 const TargetQuantity& wanted) {
  const Covariance& honest = required_covariance(rig, options.rig);
  const Covariance bound = chosen_covariance(rig, CovarianceChoice::mvb).value_or(honest);
  Basis basis;
  basis.pixel_sigma_px = options.pixel_sigma_px;
  if (!(basis.pixel_sigma_px > 0) && rig.calibration) {
    basis.pixel_sigma_px = rig.calibration->pixel_sigma_px;
  }
  if (!(basis.pixel_sigma_px > 0)) {
    throw Error(options.rig, "the file contains no corner noise",
                "give --pixel-sigma, the standard deviation of a coordinate in pixels");
  }
  const Eigen::MatrixXd honest_factor = ScaledDecomposition(honest).factor();
  const Eigen::MatrixXd bound_factor = ScaledDecomposition(bound).factor();
  const double bound_sd = sd_of(wanted, bound_factor);
  if (bound_sd > 0) basis.bound_ratio = sd_of(wanted, honest_factor) / bound_sd;
  basis.stated = honest.kind;
  if (options.covariance == "mvb") {
    basis.factor = bound_factor;
    basis.scale = basis.bound_ratio;
    basis.planned_on = bound.kind;
  } else {
    // assume that a new view is as much noisier as the previous views were
    basis.factor = honest_factor;
    basis.pixel_sigma_px *= basis.bound_ratio;
    basis.planned_on = honest.kind;
  }
  return basis;
}

double in_degrees(double rad) { return rad * 180 / std::numbers::pi; }

Json view_json(const ScoredView& view, const Camera& reference, double scale) {
  const BoardPlacement& p = view.placement;
  const Eigen::Vector3d w = vector_from_rotation(p.T_first_board.R), t = p.T_first_board.t;
  return {{"words", describe_placement(p, reference)},
          {"rotation_rad", {w.x(), w.y(), w.z()}},
          {"translation_m", {t.x(), t.y(), t.z()}},
          {"centre_px", {p.centre_px.x(), p.centre_px.y()}},
          {"distance_m", p.distance_m},
          {"turn_deg", in_degrees(p.turn_rad)},
          {"tilt_deg", in_degrees(p.tilt_rad)},
          {"sd_before", scale * view.sd_before},
          {"sd_after", scale * view.sd_after},
          {"reduction", 1 - view.sd_after / view.sd_before}};
}

std::string percent_reduction(const ScoredView& view) {
  return fmt::format("{:.1f} %", 100 * (1 - view.sd_after / view.sd_before));
}

std::string table_line(const ScoredView& view, double scale, const std::string& unit) {
  const BoardPlacement& p = view.placement;
  return fmt::format(
      "  {:>8.2f} m {:>7.0f} {:>5.0f} px {:>6.0f}° {:>6.0f}° {:>10.3g} {:<3} {:>8}\n", p.distance_m,
      p.centre_px.x(), p.centre_px.y(), in_degrees(p.turn_rad), in_degrees(p.tilt_rad),
      scale * view.sd_after, unit, percent_reduction(view));
}

std::string advice_text(const ViewAdvice& advice,
                        const TargetQuantity& wanted,
                        const Basis& basis,
                        const Camera& reference) {
  std::string text;
  for (std::size_t i = 0; i < advice.views.size(); ++i) {
    const ScoredView& view = advice.views[i];
    text += fmt::format("{}. {};\n   sd of the {}: {:.3g} before, {:.3g} {} after ({} lower)\n",
                        i + 1, describe_placement(view.placement, reference), wanted.name,
                        basis.scale * view.sd_before, basis.scale * view.sd_after, wanted.unit,
                        percent_reduction(view));
  }
  text += fmt::format(
      "\nalternatives to the first view (last line: the least helpful candidate):\n  {:>10} {:>16} "
      "{:>7} "
      "{:>7} {:>14} {:>8}\n",
      "distance", "centre", "turn", "tilt", "sd after", "lower by");
  for (const ScoredView& view : advice.alternatives) {
    text += table_line(view, basis.scale, wanted.unit);
  }
  text += table_line(advice.worst_candidate, basis.scale, wanted.unit);
  if (!advice.sd_after_more.empty()) {
    text += fmt::format("\nsd after {} such views, chosen greedily: {:.3g} {}\n",
                        advice.sd_after_more.size(), basis.scale * advice.sd_after_more.back(),
                        wanted.unit);
  }
  return text;
}

std::string basis_text(const Basis& basis) {
  std::string text =
      fmt::format("based on the covariance of kind {} and independent corner noise of {:.3g} px",
                  name(basis.planned_on), basis.pixel_sigma_px);
  if (basis.scale != 1) {
    text += fmt::format("; standard deviations scaled by {:.3g} to match kind {}", basis.scale,
                        name(basis.stated));
  }
  return text + "\n";
}

void run(const AdviseArguments& options, Session& session) {
  const RigFile file = read_rig(find_rig(options.rig));
  for (const std::string& warning : file.warnings) session.warn(warning);
  const RigEstimate rig = without_effects(file.estimate);
  const bool had_effects = file.estimate.calibration && file.estimate.calibration->effects;
  if (had_effects && !rig.calibration->effects) {
    session.warn(options.rig +
                 ": advice is for the calibration without the board's shape and motion, "
                 "from the same corners");
  }
  const std::vector<int> chosen =
      with_errors_of(options.rig, [&] { return chosen_cameras(rig.rig, options.cameras); });
  const TargetQuantity wanted =
      with_errors_of(options.rig, [&] { return wanted_of(options, rig.rig, chosen); });
  const Basis basis = with_errors_of(options.rig, [&] { return find_basis(options, rig, wanted); });
  std::vector<Eigen::Vector3d> target_m;
  Eigen::Vector2d warp_m(0, 0);
  const std::string board = find_target(options, rig, target_m, warp_m);
  const std::vector<int> must_see = options.cameras.empty() ? std::vector<int>{} : chosen;
  const Camera& reference = rig.rig.cameras[static_cast<std::size_t>(chosen[0])];
  std::vector<CandidateView> candidates;
  const ViewAdvice advice = with_errors_of(options.rig, [&] {
    candidates = candidate_views(rig.rig, target_m, warp_m, basis.pixel_sigma_px,
                                 {.cameras = must_see, .partly = options.partly});
    return advise_views(basis.factor, candidates, wanted,
                        {.views = options.views, .more = options.more});
  });

  Json json{{"reduce", options.reduce},
            {"error", wanted.name},
            {"unit", wanted.unit},
            {"board", board},
            {"sd_now", basis.scale * advice.views.front().sd_before},
            {"covariance_planned_on", name(basis.planned_on)},
            {"covariance_stated", name(basis.stated)},
            {"honest_over_bound", basis.bound_ratio},
            {"pixel_sigma_px", basis.pixel_sigma_px},
            {"candidates", candidates.size()}};
  const auto list = [&](const std::vector<ScoredView>& views) {
    Json entries = Json::array();
    for (const ScoredView& view : views) entries.push_back(view_json(view, reference, basis.scale));
    return entries;
  };
  json["views"] = list(advice.views);
  json["alternatives"] = list(advice.alternatives);
  json["least_helpful"] = view_json(advice.worst_candidate, reference, basis.scale);
  json["sd_after_more"] = Json::array();
  for (const double sd : advice.sd_after_more) json["sd_after_more"].push_back(basis.scale * sd);
  session.result(json, advice_text(advice, wanted, basis, reference) + basis_text(basis));
}

}  // namespace

void add_advise(CLI::App& app, Session& session) {
  auto o = std::make_shared<AdviseArguments>();
  CLI::App* verb = add_verb(app, session, "advise",
                            "suggest the next board poses that reduce a chosen error most",
                            "vernier advise rig.json --reduce depth --at-m 5 --views 3");
  verb->add_option("rig", o->rig, "rig file with a covariance")->required();
  verb->add_option("--cameras", o->cameras,
                   "the cameras whose error to reduce and that must see the board, as left,right "
                   "(default: all; all but projection and parameters need two)");
  verb->add_option("--reduce", o->reduce,
                   "error to reduce: depth, projection, rectification, baseline or a parameter "
                   "such as left.f_px")
      ->capture_default_str();
  verb->add_option("--at-m", o->at_m, "distance of the evaluated points, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--views", o->views, "number of views to suggest, chosen greedily")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  verb->add_option("--more", o->more, "number of views predicted in the last line")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  verb->add_option("--board", o->board,
                   "inner corners, such as 9x6 (default: the calibration's board)");
  verb->add_option("--square-m", o->square_m, "square size, metres")->check(finite_and_positive);
  verb->add_option("--pixel-sigma", o->pixel_sigma_px,
                   "noise of a pixel coordinate (default: the calibration's)")
      ->check(finite_and_positive);
  verb->add_option("--covariance", o->covariance,
                   "covariance used for planning: mvb (minimum variance bound, with scaled "
                   "results) or honest")
      ->check(CLI::IsMember({"mvb", "honest"}))
      ->capture_default_str();
  verb->add_flag(
      "--partly", o->partly,
      "allow views in which a camera sees only part of the board (boards with coded corners)");
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
