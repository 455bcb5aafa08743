// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/data_and_prior.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"

namespace vernier {

/// Something that is known of a rig: a rig file (a calibration with evidence, or a mere prior), or
/// a batch of matched pairs.
struct CombineInput {
  std::string name;
  std::optional<RigEstimate> estimate;
  PairObservations pairs;  ///< where there is no estimate
};

struct CombineOptions {
  double min_p = 1e-4;            ///< an input that disagrees more than this is left out
  bool keep_disagreeing = false;  ///< … or not
  JointOptions joint;
};

/// What became of an input.
struct CombinedInput {
  std::string name;
  std::string kind;            ///< prior, board, pairs, or board and pairs
  PriorConsistency agreement;  ///< with what stood before it; of the first: none
  bool used = true;
};

struct Combination {
  JointCalibration joint;
  JointEvidence evidence;  ///< of the inputs used
  std::vector<CombinedInput> inputs;
  JointOptions options;  ///< with what the first input holds
};

/// One calibration from many. Evidence is put together and solved as one problem
/// (calibrate_jointly): raw pairs and corners are linearised again at the common minimum, so the
/// order of the inputs does not matter and the answer is the batch solution. A rig file without
/// evidence is a prior; one with evidence brings that, its own priors included (the same prior of
/// several files counts once, and one that is another input's calibration not at all). Before it is
/// taken in, every input is compared with all before it:
/// of pairs, the prior's offset (calib/estimate/prior_consistency.h); of calibrations, their
/// difference (rig_difference.h). One that disagrees, as after a knock, is left out and said to be.
/// Throws Error where the first inputs do not determine the rig, or inputs are of other cameras or
/// lens models than the first.
Combination combine(const std::vector<CombineInput>& inputs, const CombineOptions& options = {});

}  // namespace vernier
