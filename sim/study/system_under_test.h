// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// What the trials of a cell are made from. The references outlive the system.
struct SystemSetup {
  const StudyCell& cell;
  const Visibility& visibility;  ///< of the cell's world, before furniture moves
  const RigEstimate& rig;        ///< the true one
  /// The world as it is with sources.moved; null if nothing moves.
  std::shared_ptr<const ChangedWorld> changed = nullptr;
  std::shared_ptr<const QueryPlaces> places = nullptr;              ///< of the protocol, if used
  std::shared_ptr<const ToldRigs> told = nullptr;                   ///< null: draws around the true
  std::shared_ptr<const FreshCalibrations> calibrations = nullptr;  ///< of [calibration], or null
};

/// A system that a study tries, for one cell. One thread at a time.
class SystemUnderTest {
 public:
  virtual ~SystemUnderTest() = default;
  /// A trial, which depends on the cell and the number of the trial only. One that fails before the
  /// system is asked, as for a rig that is not told, has no time.
  virtual TrialResult run(std::uint32_t trial) = 0;
};

/// The trials of a block, in order.
std::vector<TrialResult> run_block(SystemUnderTest& system, const TrialBlock& block);

/// The rigs that trials are told: those of the setup or, without, draws from the true rig's
/// covariance at the scale of sources.calibration; null if nothing is drawn.
std::shared_ptr<const ToldRigs> rigs_told(const SystemSetup& setup);

/// A trial that could not be run, with limits of its cell.
TrialResult failed_trial(const SystemSettings& system, std::uint32_t trial, std::string why);

}  // namespace vernier::sim::internal
