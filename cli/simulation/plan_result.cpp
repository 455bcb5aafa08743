// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_result.h"
#include "calib/base/shown_text.h"
#include "calib/interval.h"
#include "calib/planning/views_needed.h"
#include "cli/program/session.h"
#include "sim/study/success_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::cli {
namespace {

Json ends_json(const Interval& interval) {
  return {json_number(interval.low), json_number(interval.high)};
}

std::string in_percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string target_text(const PlanTarget& target) {
  if (target.quantity == "success") {
    return fmt::format("success {}: {}", in_percent(target.value), target.condition);
  }
  return fmt::format("{} at {:g} m: standard deviation {:g} {}", target.quantity, target.at_m,
                     target.value, target.unit);
}

std::string successes_text(const PlanResult& plan) {
  if (plan.successes.empty()) return "";
  std::string text =
      fmt::format("\n{:>22} {:>9} {:>17}\n", "calibration error", "success", "95 % interval");
  for (const SuccessAt& at : plan.successes) {
    text +=
        fmt::format("{:>15.3g} times {:>9} [{:>6.1f}, {:>6.1f}]\n", at.psi_c,
                    in_percent(at.success), 100 * at.interval_95.low, 100 * at.interval_95.high);
  }
  text += fmt::format("1 times: a standard deviation of the depth at {:g} m of {:.3g} m\n",
                      plan.target.at_m, plan.reference_sd_m);
  if (plan.scale && plan.scale->beyond) {
    text += "met at the largest error that was tried: fewer views may suffice\n";
  }
  return text;
}

std::string curve_text(const PlanResult& plan) {
  if (plan.curve.empty()) return "";
  const bool success = plan.target.quantity == "success";
  const std::string unit = success ? "m" : plan.target.unit;
  std::string text = fmt::format("\n{:>6} {:>14} {:>22}   ({} at {:g} m, calibration alone)\n",
                                 "views", "sd, " + unit, "95 % interval",
                                 success ? "depth" : plan.target.quantity, plan.target.at_m);
  for (const SdAfter& after : plan.curve) {
    text += fmt::format("{:>6} {:>14.4g} [{:>9.4g}, {:>9.4g}]\n", after.views, after.sd,
                        after.interval.low, after.interval.high);
  }
  return text;
}

std::string answer_text(const PlanResult& plan) {
  if (!plan.limit.empty()) return "cannot be reached: " + plan.limit + "\n";
  if (!plan.needed) return "not known: too few trials to tell whether it can be reached\n";
  const ViewsNeeded& needed = *plan.needed;
  if (plan.from_calibration && needed.interval.high <= plan.known.taken) {
    return fmt::format("reached: the {} so far {}\n", counted(plan.known.taken, "view"),
                       plan.known.taken == 1 ? "suffices" : "suffice");
  }
  const int more = std::max(0, needed.views - plan.known.taken);
  const std::string so_far =
      plan.from_calibration ? fmt::format("{} so far", plan.known.taken) : "";
  if (!std::isfinite(needed.interval.high)) {
    return fmt::format("views needed: {:.0f} or more, without an upper end{}\n",
                       needed.interval.low, so_far.empty() ? "" : " (" + so_far + ")");
  }
  std::string text =
      fmt::format("views needed: {}, {:.0f} to {:.0f} with {:.0f} % confidence", needed.views,
                  needed.interval.low, needed.interval.high, 100 * needed.confidence);
  if (plan.from_calibration) text += fmt::format(" ({}, about {} more)", so_far, more);
  text += "\n";
  if (plan.needed_by_all && plan.needed_by_all->views < needed.views) {
    text += by_all_text(*plan.needed_by_all) + "\n";
  }
  return text;
}

}  // namespace

std::string by_all_text(const ViewsNeeded& needed) {
  return fmt::format(
      "{}, {:.0f} to {:.0f} with {:.0f} % confidence, if all cameras see the board in the further "
      "ones",
      counted(needed.views, "view"), needed.interval.low, needed.interval.high,
      100 * needed.confidence);
}

bool has_partial_frames(const ViewKnowledge& known) { return known.taken_by_all() < known.taken; }

std::string partial_frames_text(const ViewKnowledge& known) {
  if (!has_partial_frames(known)) return "";
  return fmt::format(" ({} of {} are seen by all cameras)", known.taken_by_all(), known.taken);
}

Json plan_json(const PlanResult& plan) {
  Json json{{"target",
             {{"quantity", plan.target.quantity},
              {"value", plan.target.value},
              {"unit", plan.target.unit},
              {"at_m", plan.target.at_m},
              {"success_error", json_number(plan.target.success_error)}}},
            {"basis", plan.basis},
            {"from", plan.from_calibration ? "calibration" : "datasheet"},
            {"views_so_far", plan.known.taken},
            {"views_so_far_by_all", plan.known.taken_by_all()},
            {"noise_px", plan.known.noise_px},
            {"inflation", plan.known.inflation},
            {"reachable", plan.is_reachable() ? Json(*plan.is_reachable()) : Json()},
            {"limit", plan.limit},
            {"views", plan.needed ? Json(plan.needed->views) : Json()},
            {"views_interval", plan.needed ? ends_json(plan.needed->interval) : Json()},
            {"views_by_all", plan.needed_by_all ? Json(plan.needed_by_all->views) : Json()},
            {"views_by_all_interval",
             plan.needed_by_all ? ends_json(plan.needed_by_all->interval) : Json()},
            {"views_by_all_confidence",
             plan.needed_by_all ? Json(plan.needed_by_all->confidence) : Json()},
            {"confidence", plan.needed ? Json(plan.needed->confidence) : Json()},
            {"stated_sd", json_number(plan.stated_sd)},
            {"sd_allowed", plan.sd_allowed ? Json(*plan.sd_allowed) : Json()},
            {"pixel_noise_sd_m", json_number(plan.pixel_noise_sd)},
            {"pair_sigma_px", plan.pair_sigma_px},
            {"curve", Json::array()},
            {"success", Json::array()},
            {"limiting_causes", Json::array()}};
  for (const SdAfter& after : plan.curve) {
    json["curve"].push_back({{"views", after.views},
                             {"sd", json_number(after.sd)},
                             {"interval_95", ends_json(after.interval)}});
  }
  for (const SuccessAt& at : plan.successes) {
    json["success"].push_back({{"calibration", at.psi_c},
                               {"success", at.success},
                               {"success_interval_95", ends_json(at.interval_95)},
                               {"failed", at.failed}});
  }
  for (const LimitingCause& cause : plan.causes) {
    json["limiting_causes"].push_back({{"without", cause.name}, {"success", cause.success}});
  }
  return json;
}

std::string plan_text(const PlanResult& plan) {
  std::string text = target_text(plan.target) + "\n" + answer_text(plan);
  text += fmt::format("from {}; noise {:.3g} px", plan.basis, plan.known.noise_px);
  if (plan.from_calibration) {
    text += fmt::format(" (smooth over the board; {:.2f} times what white residuals would have)",
                        std::sqrt(plan.known.inflation));
  }
  text += "\n" + successes_text(plan) + curve_text(plan);
  if (plan.target.quantity == "depth" && std::isfinite(plan.pixel_noise_sd)) {
    text +=
        plan.pair_sigma_px > 0
            ? fmt::format("\nincluded: {:.3g} m by {:g} px of noise in both images of a match\n",
                          plan.pixel_noise_sd, plan.pair_sigma_px)
            : fmt::format(
                  "\nnot included: {:.3g} m by {:.3g} px of noise in both images of a "
                  "match (--pair-sigma-px)\n",
                  plan.pixel_noise_sd, plan.known.residual_px());
  }
  for (const LimitingCause& cause : plan.causes) {
    text += fmt::format("without {}: success {}\n", cause.name, in_percent(cause.success));
  }
  return text;
}

}  // namespace vernier::cli
