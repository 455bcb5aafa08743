// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/combine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

#include "calib/calibration/combine_evidence.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/pair_checks.h"
#include "calib/calibration/pairs_alone.h"
#include "calib/calibration/result_checks.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/error.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/estimate/same_rig.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier {

using namespace internal;

namespace {

std::string kind_of(const CombineInput& input) {
  if (!input.estimate || (has_pairs(*input.estimate) && !has_boards(*input.estimate))) {
    return "pairs";
  }
  if (has_boards(*input.estimate)) {
    return has_pairs(*input.estimate) ? "board and pairs" : "board";
  }
  return "prior";
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

void add(JointEvidence& to, const JointEvidence& more) {
  const std::vector<GaussianRigPrior> priors = new_priors(to.priors, more.priors);
  to.priors.insert(to.priors.end(), priors.begin(), priors.end());
  to.boards.insert(to.boards.end(), more.boards.begin(), more.boards.end());
  append(to.pairs, more.pairs);
}

/// The numbers of image pairs, and those that they have at the end of `all`.
std::vector<std::pair<int, int>> numbers_in(const PairObservations& all,
                                            const PairObservations& last) {
  const std::size_t before = all.image_pairs.size() - last.image_pairs.size();
  std::vector<std::pair<int, int>> numbers;
  for (std::size_t i = 0; i < last.image_pairs.size(); ++i) {
    numbers.emplace_back(last.image_pairs[i].number, all.image_pairs[before + i].number);
  }
  return numbers;
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

/// Consistency of the pairs with the previous inputs, by the rig that they want themselves.
PriorConsistency agreement_of_pairs(const GaussianRigPrior& before,
                                    const PairObservations& pairs,
                                    const CombineInput& input,
                                    JointOptions options) {
  constexpr double most_left_out = 1.0 / 3;
  options.place = input.name;
  const PairsAlone alone = pairs_alone(pairs, before, options);
  if (alone.left_out_share() > most_left_out) {
    throw Error(input.name,
                fmt::format("{} of its {} pairs fit no rig near that of the previous inputs",
                            alone.outliers(), pairs.size()),
                "the rig has changed, or many matches are wrong");
  }
  return consistency_with(before, alone.joint.estimate, alone.wider);
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
void add_warnings(const std::vector<CombineInput>& inputs, double min_p, Combination& combination) {
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
    const double p = i > 0 ? input.agreement.p_value : 1;
    if (input.used && !(p < min_p)) {
      constexpr double low_p = 0.01;
      if (p < low_p) {
        summary.warnings.push_back(fmt::format(
            "{} is barely consistent with the previous inputs (p {:.1g})", input.name, p));
      }
      continue;
    }
    if (input.agreement.dof == 0) {
      summary.trust_warnings.push_back(
          fmt::format("{} was {}: {}", input.name,
                      input.used ? "kept, though it cannot be compared" : "excluded",
                      input.agreement.description));
      continue;
    }
    summary.trust_warnings.push_back(
        fmt::format("{} is inconsistent with the previous inputs (chi² {:.1f} for {}, p {:.1g}) "
                    "and was {}: the rig has changed, or one of them understates its uncertainty",
                    input.name, input.agreement.chi2, input.agreement.dof, p,
                    input.used ? "kept" : "excluded"));
  }
}

}  // namespace

Combination combine(const std::vector<CombineInput>& inputs, const CombineOptions& options) {
  if (inputs.empty()) throw Error("combination", "there is no input", "give rig files or pairs");
  if (!inputs.front().estimate) {
    throw Error(inputs.front().name, "pairs alone do not determine a rig",
                "give a prior or a board calibration first");
  }
  if (!(options.min_p >= 0 && options.min_p <= 1)) {
    throw Error("min_p", "it is not a number from 0 to 1",
                "give the smallest p-value of an input that is used");
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
    combined.image_pairs = numbers_in(result.evidence.pairs, evidence.pairs);
    if (&input == &inputs.back()) break;
    before = result.inputs.size() == 1
                 ? gaussian_prior_of(*input.estimate, input.name)
                 : gaussian_prior_of(calibrate_jointly(result.evidence, before->rig, joint));
  }
  result.joint = calibrate_jointly(result.evidence, start, joint);
  add_warnings(inputs, options.min_p, result);
  const RigEstimate& estimate = result.joint.estimate;
  CalibrationSummary& summary = *result.joint.estimate.calibration;
  const auto folds = inversion_warnings(estimate.rig);
  summary.warnings.insert(summary.warnings.end(), folds.begin(), folds.end());
  const auto curved = curvature_warning(estimate.rig, *estimate.covariance);
  if (curved) summary.trust_warnings.push_back(*curved);
  return result;
}

}  // namespace vernier
