// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/combine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "calib/calibration/observation_checks.h"
#include "calib/calibration/pair_checks.h"
#include "calib/calibration/result_checks.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/held_parameters.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/prior_consistency.h"
#include "calib/rig.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

using namespace internal;

namespace {

bool has_boards(const RigEstimate& estimate) {
  return estimate.evidence && !estimate.evidence->observations.views.empty();
}
bool has_pairs(const RigEstimate& estimate) {
  return estimate.evidence && estimate.evidence->pairs.size() > 0;
}

std::string kind_of(const CombineInput& input) {
  if (!input.estimate || (has_pairs(*input.estimate) && !has_boards(*input.estimate))) {
    return "pairs";
  }
  if (has_boards(*input.estimate)) {
    return has_pairs(*input.estimate) ? "board and pairs" : "board";
  }
  return "prior";
}

/// Whether the priors are equal up to the rounding of a file.
bool same(const GaussianRigPrior& a, const GaussianRigPrior& b) {
  constexpr double rounding = 1e-9;
  if (a.covariance.names != b.covariance.names) return false;
  if (parameter_names(a.rig) != parameter_names(b.rig)) return false;
  const Eigen::MatrixXd &A = a.covariance.matrix, &B = b.covariance.matrix;
  const Eigen::VectorXd sd = A.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index k = 0; k < A.cols(); ++k) {
      if (std::abs(A(i, k) - B(i, k)) > rounding * sd[i] * sd[k]) return false;
    }
  }
  const std::vector<std::string> all = parameter_names(a.rig);
  const Eigen::VectorXd x = parameters(a.rig), y = parameters(b.rig);
  for (const std::string& name : a.covariance.names) {  // the others are not covered
    const auto i = std::find(all.begin(), all.end(), name) - all.begin();
    if (!(std::abs(x[i] - y[i]) <= rounding * (1e-3 + std::abs(x[i])))) return false;
  }
  return true;
}

/// The first match of every image pair.
std::set<std::array<double, 4>> first_matches(const PairObservations& pairs) {
  std::set<std::array<double, 4>> first;
  for (const ImagePair& image : pairs.image_pairs) {
    const Eigen::Vector4d& y = pairs.pixels_px[image.first];
    first.insert({y[0], y[1], y[2], y[3]});
  }
  return first;
}

/// Rejects repeated data, which would count twice.
void refuse_repeated(const JointEvidence& so_far,
                     const JointEvidence& more,
                     const Rig& rig,
                     const std::string& name) {
  const auto before = first_matches(so_far.pairs);
  for (const auto& first : first_matches(more.pairs)) {
    if (!before.count(first)) continue;
    throw Error(name, "it repeats image pairs of a previous input",
                "give every batch once, on its own or in a rig file");
  }
  for (const BoardTerm& b : more.boards) {
    for (const BoardTerm& a : so_far.boards) {
      if (shared_views(a.evidence, rig, b.evidence, rig) == 0) continue;
      throw Error(name, "it repeats board views of a previous input", "give every view once");
    }
  }
}

/// The priors of `more` that are not among `so_far`.
std::vector<GaussianRigPrior> new_priors(const std::vector<GaussianRigPrior>& so_far,
                                         const std::vector<GaussianRigPrior>& more) {
  std::vector<GaussianRigPrior> added;
  for (const GaussianRigPrior& prior : more) {
    const auto is_same = [&](const GaussianRigPrior& p) { return same(p, prior); };
    if (std::none_of(so_far.begin(), so_far.end(), is_same)) added.push_back(prior);
  }
  return added;
}

void add(JointEvidence& to, const JointEvidence& more) {
  const std::vector<GaussianRigPrior> priors = new_priors(to.priors, more.priors);
  to.priors.insert(to.priors.end(), priors.begin(), priors.end());
  to.boards.insert(to.boards.end(), more.boards.begin(), more.boards.end());
  append(to.pairs, more.pairs);
}

void check_models(const Rig& first, const CombineInput& input) {
  if (!input.estimate) {
    check_pairs(input.pairs, first, input.name);
    return;
  }
  const Rig& rig = input.estimate->rig;
  check_same_cameras(first, rig, input.name);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (rig.cameras[c].model.index() == first.cameras[c].model.index()) continue;
    throw Error(
        input.name,
        fmt::format("its {} lens model is {}, in the first input it is {}", rig.cameras[c].name,
                    model_name(rig.cameras[c].model), model_name(first.cameras[c].model)),
        "calibrate with the same model");
  }
}

/// A joint calibration as a prior for what comes next.
GaussianRigPrior gaussian_prior_of(const JointCalibration& joint) {
  return gaussian_prior_of(joint.estimate, "combination");
}

/// Consistency of the pairs with the previous inputs.
PriorConsistency agreement_of_pairs(const GaussianRigPrior& before,
                                    const PairObservations& pairs,
                                    const CombineInput& input,
                                    const JointOptions& options) {
  // Compare with a solution under a ten times wider prior, so that a wrong prior does not bias the
  // rig; with the prior itself if the pairs do not determine the rig under the wide one.
  constexpr double wider = 10;
  GaussianRigPrior loose = before;
  loose.covariance.matrix *= wider * wider;
  try {
    const JointCalibration with = calibrate_from_pairs(pairs, loose, options, input.name);
    return consistency_with(before, with.estimate, wider);
  } catch (const Error&) {
    const JointCalibration with = calibrate_from_pairs(pairs, before, options, input.name);
    return consistency_with(before, with.estimate);
  }
}

PriorConsistency agreement_of_rigs(const GaussianRigPrior& before,
                                   const RigEstimate& estimate,
                                   const std::string& name) {
  const RigDifference d = rig_difference(before.rig, full_covariance(before), estimate.rig,
                                         required_covariance(estimate, name));
  PriorConsistency agreement{d.mahalanobis2, d.dof, 0, d.p_value, 0, ""};
  if (!d.directions.empty()) {
    agreement.in_sigma = std::abs(d.directions.front().in_sigma);
    agreement.description = d.directions.front().description;
  }
  return agreement;
}

PriorConsistency agreement_of(const GaussianRigPrior& before,
                              const JointEvidence& so_far,
                              const CombineInput& input,
                              const JointEvidence& evidence,
                              const JointOptions& options) {
  if (kind_of(input) == "pairs" && new_priors(so_far.priors, evidence.priors).empty()) {
    return agreement_of_pairs(before, evidence.pairs, input, options);
  }
  return agreement_of_rigs(before, *input.estimate, input.name);
}

/// Warns of priors that are themselves calibrations, whose data may be among the inputs too.
void warn_of_priors(const JointEvidence& evidence, CalibrationSummary& summary) {
  for (const GaussianRigPrior& prior : evidence.priors) {
    if (prior.covariance.kind == CovarianceKind::prior) continue;
    summary.warnings.push_back(
        fmt::format("a prior among the inputs is itself a calibration ({}): if its data are among "
                    "the inputs too, they count twice",
                    name(prior.covariance.kind)));
    return;
  }
}

/// Collects the warnings of the inputs, of the scene of all pairs, and about excluded inputs.
void add_warnings(const std::vector<CombineInput>& inputs, Combination& combination) {
  CalibrationSummary& summary = *combination.joint.estimate.calibration;
  warn_of_priors(combination.evidence, summary);
  const bool first_is_prior = kind_of(inputs.front()) == "prior";
  if (first_is_prior && !combination.options.held.empty()) {
    std::string names;
    for (const HeldParameter& held : combination.options.held) names += " " + held.name;
    summary.warnings.push_back("fixed, since " + inputs.front().name +
                               " gives them no variance:" + names);
  }
  const PairObservations& pairs = combination.evidence.pairs;
  if (pairs.size() > 0 && combination.evidence.boards.empty()) {
    std::vector<bool> inlier(pairs.size(), true);
    for (const PairOutlier& out : summary.pair_outliers) inlier[out.row] = false;
    const ObservationDiagnosis diagnosis =
        check_scene(selected(pairs, inlier), combination.joint.estimate.rig,
                    combination.joint.pair_sigma_scale);
    summary.warnings.insert(summary.warnings.end(), diagnosis.warnings.begin(),
                            diagnosis.warnings.end());
    summary.trust_warnings.insert(summary.trust_warnings.end(), diagnosis.trust_warnings.begin(),
                                  diagnosis.trust_warnings.end());
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const CombinedInput& input = combination.inputs[i];
    if (input.used && inputs[i].estimate && inputs[i].estimate->calibration) {
      for (const std::string& trust_warning : inputs[i].estimate->calibration->trust_warnings) {
        const auto& listed = summary.trust_warnings;
        const bool again = std::find(listed.begin(), listed.end(), trust_warning) != listed.end();
        if (!again && inputs.size() > 1)
          summary.trust_warnings.push_back(input.name + ": " + trust_warning);
      }
    }
    if (input.used) {
      constexpr double low_p = 0.01;
      if (i > 0 && input.agreement.p_value < low_p) {
        summary.warnings.push_back(
            fmt::format("{} is barely consistent with the previous inputs (p {:.1g})", input.name,
                        input.agreement.p_value));
      }
      continue;
    }
    if (input.agreement.dof == 0) {
      summary.trust_warnings.push_back(input.name +
                                       " was excluded: " + input.agreement.description);
      continue;
    }
    summary.trust_warnings.push_back(fmt::format(
        "{} is inconsistent with the previous inputs (chi² {:.1f} for {}, p {:.1g}) and was "
        "excluded: the rig has changed, or one of them understates its uncertainty",
        input.name, input.agreement.chi2, input.agreement.dof, input.agreement.p_value));
  }
}

/// Parameters that no input may change: those without variance in the first.
JointOptions with_held(JointOptions options, const CombineInput& first) {
  if (!first.estimate) return options;
  for (const HeldParameter& held : held_by(gaussian_prior_of(*first.estimate, first.name))) {
    options.held.push_back(held);
  }
  return options;
}

/// Evidence of the inputs, without priors that are the calibration of another input.
std::vector<JointEvidence> evidence_of_all(const std::vector<CombineInput>& inputs) {
  std::vector<GaussianRigPrior> calibrations;
  std::vector<JointEvidence> all;
  for (const CombineInput& input : inputs) {
    all.push_back(evidence_of(input));
    const bool prior_only = all.back().boards.empty() && all.back().pairs.size() == 0;
    if (input.estimate && input.estimate->covariance && !prior_only) {
      calibrations.push_back(gaussian_prior_of(*input.estimate, input.name));
    }
  }
  for (JointEvidence& evidence : all) {
    std::erase_if(evidence.priors, [&](const GaussianRigPrior& prior) {
      return std::any_of(calibrations.begin(), calibrations.end(),
                         [&](const GaussianRigPrior& c) { return same(c, prior); });
    });
  }
  return all;
}

}  // namespace

JointEvidence evidence_of(const CombineInput& input) {
  JointEvidence evidence;
  if (!input.estimate) {
    evidence.pairs = input.pairs;
    return evidence;
  }
  const RigEstimate& estimate = *input.estimate;
  if (has_boards(estimate)) {
    CalibrationEvidence boards = *estimate.evidence;
    boards.pairs = {};
    boards.priors.clear();
    const double sigma = estimate.calibration ? estimate.calibration->pixel_sigma_px : 1;
    evidence.boards.push_back({std::move(boards), sigma});
  }
  if (has_pairs(estimate)) evidence.pairs = estimate.evidence->pairs;
  if (estimate.evidence) evidence.priors = estimate.evidence->priors;
  if (!has_boards(estimate) && !has_pairs(estimate)) {
    evidence.priors = {gaussian_prior_of(estimate, input.name)};
  }
  return evidence;
}

Combination combine(const std::vector<CombineInput>& inputs, const CombineOptions& options) {
  if (inputs.empty()) throw Error("combination", "there is no input", "give rig files or pairs");
  if (!inputs.front().estimate) {
    throw Error(inputs.front().name, "pairs alone do not determine a rig",
                "give a prior or a board calibration first");
  }
  const Rig& start = inputs.front().estimate->rig;
  const JointOptions joint = with_held(options.joint, inputs.front());
  Combination result;
  result.options = joint;
  const std::vector<JointEvidence> all = evidence_of_all(inputs);
  std::optional<GaussianRigPrior> before;
  for (const CombineInput& input : inputs) {
    check_models(start, input);
    const JointEvidence& evidence = all[static_cast<std::size_t>(&input - inputs.data())];
    CombinedInput& combined = result.inputs.emplace_back();
    combined.name = input.name;
    combined.kind = kind_of(input);
    refuse_repeated(result.evidence, evidence, start, input.name);
    if (before) {
      try {
        combined.agreement = agreement_of(*before, result.evidence, input, evidence, joint);
      } catch (const Error& error) {  // it cannot be compared, so it is not used
        combined.agreement = {0, 0, 0, 0, 0, error.what()};
      }
      combined.used = options.keep_disagreeing || combined.agreement.p_value >= options.min_p;
      if (!combined.used) continue;
    }
    add(result.evidence, evidence);
    if (&input == &inputs.back()) break;
    before = result.inputs.size() == 1
                 ? gaussian_prior_of(*input.estimate, input.name)
                 : gaussian_prior_of(calibrate_jointly(result.evidence, before->rig, joint));
  }
  result.joint = calibrate_jointly(result.evidence, start, joint);
  add_warnings(inputs, result);
  auto& warnings = result.joint.estimate.calibration->warnings;
  const auto folds = inversion_warnings(result.joint.estimate.rig);
  warnings.insert(warnings.end(), folds.begin(), folds.end());
  return result;
}

InformationFilterResult information_filter(const std::vector<CombineInput>& inputs,
                                           const Combination& batch,
                                           const CombineOptions& options) {
  JointOptions joint = with_held(options.joint, inputs.front());
  joint.white_noise = true;
  GaussianRigPrior known = gaussian_prior_of(*inputs.front().estimate, inputs.front().name);
  const RigEstimate& first = *inputs.front().estimate;
  if (first.covariance_mvb && has_boards(first)) {
    known.covariance.matrix =
        covariance_of_free(*first.covariance_mvb, first.rig, held_parameters(first));
  }
  const std::vector<JointEvidence> all = evidence_of_all(inputs);
  std::vector<GaussianRigPrior> used = all.front().priors;
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    if (!batch.inputs[i].used) continue;
    JointEvidence evidence = all[i];
    evidence.priors = new_priors(used, evidence.priors);
    used.insert(used.end(), evidence.priors.begin(), evidence.priors.end());
    evidence.priors.push_back(known);
    known = gaussian_prior_of(calibrate_jointly(evidence, known.rig, joint));
  }
  InformationFilterResult filtered{known.rig, known.covariance, 0, "", 1, ""};
  const Eigen::MatrixXd& honest = batch.joint.estimate.covariance->matrix;
  const Eigen::MatrixXd own = full_covariance(known).matrix;
  const Eigen::VectorXd d = difference(known.rig, batch.joint.estimate.rig);
  const Eigen::MatrixXd& C = *batch.joint.estimate.covariance_mvb;
  const std::vector<std::string> names = parameter_names(known.rig);
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    if (!(C(i, i) > 0)) continue;
    const double ratio = std::sqrt(own(i, i) / honest(i, i));
    if (ratio < filtered.min_sigma_ratio) {
      filtered.min_sigma_ratio = ratio;
      filtered.min_parameter = names[static_cast<std::size_t>(i)];
    }
    const double in_sigma = std::abs(d[i]) / std::sqrt(C(i, i));
    if (in_sigma <= filtered.worst_in_sigma) continue;
    filtered.worst_in_sigma = in_sigma;
    filtered.worst_parameter = names[static_cast<std::size_t>(i)];
  }
  return filtered;
}

}  // namespace vernier
