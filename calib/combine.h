// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/data_and_prior.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"

namespace vernier {

/// One input about a rig: a rig file (a calibration with evidence, or only a prior), or a batch of
/// matched pairs.
struct CombineInput {
  std::string name;
  std::optional<RigEstimate> estimate;
  PairObservations pairs;  ///< if there is no estimate
};

struct CombineOptions {
  double min_p = 1e-4;            ///< in [0, 1]: an input with a smaller p-value is excluded …
  bool keep_disagreeing = false;  ///< … unless this is set
  JointOptions joint;
};

/// The result for one input.
struct CombinedInput {
  std::string name;
  std::string kind;            ///< prior, board, pairs, or board and pairs
  PriorConsistency agreement;  ///< with the previous inputs; none for the first
  bool used = true;
  /// Of each of its image pairs, if used: its number in the input, and in the combination, whose
  /// numbers its messages give.
  std::vector<std::pair<int, int>> image_pairs;
};

struct Combination {
  JointCalibration joint;
  JointEvidence evidence;  ///< of the inputs used
  std::vector<CombinedInput> inputs;
  JointOptions options;  ///< with the parameters held by the first input
};

/// One calibration from several inputs. All evidence is solved as one problem (calibrate_jointly):
/// raw pairs and corners are linearised again at the common minimum, so the order of the inputs
/// does not matter and the result is the batch solution, without random effects, which the joint
/// cost has not. A rig file without evidence is a prior; one with evidence contributes that, its
/// own priors included (a prior contained in several files counts once, and one that is the
/// calibration of another input not at all). Every input is compared with all previous ones before
/// it is used: pairs by the prior's offset (calib/estimate/prior_consistency.h), calibrations by
/// their difference (rig_difference.h). An inconsistent one, as after a mechanical shock, is
/// excluded and reported. Throws Error if the first inputs do not determine the rig, or inputs
/// differ from the first in cameras or lens models.
Combination combine(const std::vector<CombineInput>& inputs, const CombineOptions& options = {});

}  // namespace vernier
