// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/information_filter.h"

#include <cmath>
#include <cstddef>

#include "calib/calibration/combine_evidence.h"
#include "calib/combine.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

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
    known =
        gaussian_prior_of(calibrate_jointly(evidence, known.rig, joint).estimate, "combination");
  }
  InformationFilterResult filtered{known.rig, known.covariance, 0, "", 1, ""};
  const Eigen::MatrixXd& honest = batch.joint.estimate.covariance->matrix;
  const Eigen::MatrixXd own = full_covariance(known).matrix;
  const Eigen::VectorXd d =
      StableCoordinates(batch.joint.estimate.rig, honest).coordinates(known.rig);
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

}  // namespace vernier::internal
