// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_success.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/planning/views_needed.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "calib/uncertainty/target_quantity.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/plan_result.h"
#include "cli/simulation/study_inputs.h"
#include "cli/simulation/system_table.h"
#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/success_curve.h"
#include "sim/study/system_kind.h"
#include "sim/study/told_settings.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// The covariance after the views so far, or after ten of a datasheet's.
Covariance reference_covariance(const ViewKnowledge& known) {
  const ViewPool& pool = known.pools[0];
  const std::vector<Eigen::MatrixXd>& views =
      pool.taken.empty() ? pool.following[0].views : pool.taken;
  constexpr std::size_t enough = 10;
  const std::size_t count = pool.taken.empty() ? std::min(enough, views.size()) : views.size();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(pool.free.cols(), pool.free.cols());
  for (std::size_t i = 0; i < count; ++i) S += views[i];
  if (pool.prior.size() > 0) S += known.noise_px * known.noise_px * pool.prior;
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Cholesky factor(scale.asDiagonal() * S * scale.asDiagonal());
  if (!factor.is_positive_definite()) {
    throw Error("plan", "the views so far do not determine the rig", "take more views");
  }
  const Eigen::MatrixXd C = known.noise_px * known.noise_px *
                            (scale.asDiagonal() * factor.inverse() * scale.asDiagonal());
  const Eigen::MatrixXd full = pool.free * C * pool.free.transpose();
  return {CovarianceKind::mvb, parameter_names(pool.rig), 0.5 * (full + full.transpose())};
}

/// Throws Error for a study whose trials say nothing of a calibration's error alone.
void check_can_be_planned(const StudyFile& study) {
  const StudyCell& cell = study.cells[0];
  if (study.cells.size() != 1) {
    const bool designed = study.lines.contains("one_at_a_time");
    throw Error(place_of(study, designed ? "one_at_a_time" : study.sweep_keys[0]),
                fmt::format("the study has {} cells", study.cells.size()),
                "give plan a study of one, without [sweep] and [one_at_a_time]");
  }
  if (const SystemKind& kind = system_of(study); kind.sources == SourcesUsed::none) {
    throw Error(place_of(study, "system.name"),
                "the error of a rig's calibration does not act on " + kind.noun,
                "give --depth-error or --projection-error, or another system");
  }
  const char* remedy = "leave it out: plan draws what is told of the rig";
  if (cell.told.calibration) {
    throw Error(place_of(study, "calibration"), "[calibration] calibrates anew for each trial",
                remedy);
  }
  if (!cell.told.truth.empty()) {
    throw Error(place_of(study, "rig.truth"), "rig.truth tells another rig than the true one",
                remedy);
  }
}

/// The study of a localiser that the options describe.
Study study_of_localiser(const SuccessTrials& trials, std::uint64_t seed) {
  StudyCell cell;
  cell.label = "plan";
  cell.world = trials.world;
  cell.experiment.protocol = query_protocol(trials.protocol);
  cell.experiment.method = trials.method;
  cell.experiment.seed = seed;
  cell.system.success_error = trials.within_m;
  cell.settings = settings_of(cell.experiment);
  Study study;
  study.file.world = trials.world;
  study.file.place = "plan";
  study.file.cells.push_back(std::move(cell));
  study.world = build_world(read_world(find_world(trials.world)));
  return study;
}

/// "within 0.1 m", "depth error at most 0.05 m"
std::string condition_text(const StudyFile& study) {
  const SystemKind& kind = system_of(study);
  const bool is_localiser = study.cells[0].system.is_localiser();
  return (is_localiser ? "within " : kind.error_title + " at most ") + limit_text(study);
}

/// The cause without which success rises by more than its interval's half width, if there is one.
std::string causes_in_words(const PlanResult& plan, const Study& study) {
  const SuccessAt& now = plan.successes[0];
  const double noise = 0.5 * (now.interval_95.high - now.interval_95.low);
  if (!plan.causes.empty() && plan.causes[0].success > now.success + noise) {
    return fmt::format("first {} (without it {:.1f} %)", plan.causes[0].name,
                       100 * plan.causes[0].success);
  }
  if (study.file.cells[0].system.is_localiser()) {
    return "no single source of error, but the localiser, its map or places that look alike "
           "(vernier study gives the world's ceiling)";
  }
  return system_of(study.file).noun + " itself, or what it is given beside the rig";
}

/// Trials that a program or a source of error spoilt count as failures, which is to be known.
void tell_failed(const std::vector<SuccessAt>& successes, int trials, Session& session) {
  int failed = 0;
  std::string why;
  for (const SuccessAt& at : successes) {
    if (failed == 0) why = at.why_failed;
    failed += at.failed;
  }
  if (failed == 0) return;
  session.warn(fmt::format("plan: {} of {} trials gave no result, and count as failures{}{}",
                           failed, trials * static_cast<int>(successes.size()),
                           why.empty() ? "" : ": ", why));
}

}  // namespace

void add_success_options(CLI::App& verb, SuccessTrials& trials) {
  verb.add_option(
      "--study", trials.study,
      "study file whose trials are to succeed, of any system, in place of --world, "
      "--protocol, --method and --within-m; the rig is the one that is planned for, its "
      "own if none is given");
  verb.add_option("--world", trials.world, "world of --success, a shipped name or a file")
      ->capture_default_str();
  verb.add_option("--protocol", trials.protocol, "near_path, path, anywhere or free")
      ->capture_default_str();
  verb.add_option("--method", trials.method, "localiser of --success")->capture_default_str();
  verb.add_option("--within-m", trials.within_m,
                  "a localiser's answer is right up to this distance from the truth, metres")
      ->check([](const std::string& text) {
        const std::string fault = finite_and_positive(text);
        if (!fault.empty() || to_finite(text).value_or(0) <= success_radius_m) return fault;
        return in_quotes(text) +
               fmt::format(" is above {:g}: an answer further away is another place",
                           success_radius_m);
      })
      ->capture_default_str();
  verb.add_option(
          "--trials", trials.trials,
          "trials at each scale of the calibration's error, of which there are six and those "
          "that close in on the target (--study: as many as it says, unless given)")
      ->check(CLI::Range(12, 100'000))
      ->capture_default_str();
  verb.add_option("--threads", trials.threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
}

Study study_of(const SuccessTrials& trials,
               std::uint64_t seed,
               const CLI::App& app,
               Session& session) {
  Study study;
  if (trials.study.empty()) {
    study = study_of_localiser(trials, seed);
  } else {
    refuse_options(app, std::array{"--world", "--protocol", "--method", "--within-m"},
                   "the study says it");
    const StudyFile file = read_study(trials.study);
    check_can_be_planned(file);
    study = load_inputs_without_rig(file, fs::path(trials.study).parent_path(), session);
  }
  if (trials.study.empty() || app.count("--trials") > 0) {
    const bool shares_maps = study.file.cells[0].system.is_localiser();
    study.file.trials = trials.trials;
    study.file.trials_per_block =
        shares_maps ? block_size(trials.trials) : independent_block_size(trials.trials);
  }
  return study;
}

void allow_for_success(Study study, int threads, PlanResult& plan, Session& session) {
  const Rig& rig = plan.known.pools[0].rig;
  const Covariance covariance = reference_covariance(plan.known);
  const TargetQuantity depth = target_quantity(rig, "depth", plan.target.at_m);
  const double reference_sd = sd_of(depth, ScaledDecomposition(covariance).factor());
  plan.target.condition = condition_text(study.file);
  plan.target.success_error = study.file.cells[0].system.success_error;
  study.rig = RigEstimate();
  study.rig.rig = rig;
  study.rig.covariance = covariance;
  std::optional<Progress> progress;
  const SuccessCurveOptions how{.threads = threads, .progress = [&](int done, int total) {
                                  if (!progress)
                                    progress.emplace(session, "plan: blocks of trials");
                                  progress->update(done, total);
                                }};
  plan.trials = study.file.trials;
  plan.reference_sd_m = reference_sd;
  plan.successes = success_curve_about(study, plan.target.value, how);
  progress.reset();
  tell_failed(plan.successes, study.file.trials, session);
  plan.scale = scale_needed(plan.successes, plan.target.value);
  const SuccessAt& best = plan.successes[0];
  if (best.interval_95.high < plan.target.value) {
    plan.causes = limiting_causes(study, how);
    plan.limit = fmt::format(
        "without any calibration error success is {:.1f} % [{:.1f}, {:.1f}]; what limits is {}",
        100 * best.success, 100 * best.interval_95.low, 100 * best.interval_95.high,
        causes_in_words(plan, study));
    return;
  }
  if (plan.scale->psi_c > 0) plan.sd_allowed = plan.scale->psi_c * reference_sd;
}

ViewsNeeded views_for_success(const PlanResult& plan,
                              const ViewKnowledge& known,
                              ViewPlanOptions how) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const ScaleNeeded& scale = *plan.scale;
  const bool may_be_out_of_reach = !(scale.low > 0);
  if (may_be_out_of_reach) {
    how.widest = infinity;  // it has no upper end
  } else {
    how.target_log_sd_below = std::log(scale.psi_c / scale.low) / z_95;
  }
  how.target_log_sd_above = std::log(scale.high / scale.psi_c) / z_95;  // ends hold 95 %
  ViewsNeeded needed = views_needed(known, "depth", plan.target.at_m, *plan.sd_allowed, how);
  const bool is_beyond = needed.views >= how.most_views;
  if (may_be_out_of_reach || (!needed.is_reached && !is_beyond)) {
    needed.interval.high = infinity;
    needed.is_reached = true;
  }
  return needed;
}

}  // namespace vernier::cli
