// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// Where queries stand and what they see there.
struct QueryWorld {
  std::shared_ptr<const ChangedWorld> changed;  ///< null if nothing has moved
  std::shared_ptr<const QueryPlaces> places;
};

/// What cells of a study share while it runs: each world with what is visible in it, the places of
/// queries, the calibrations that are told. From any thread; keeps a reference to the study.
class StudyScenes {
 public:
  /// Builds the visibility of every world.
  explicit StudyScenes(const Study& study);

  /// Of the cell's world as the map is recorded in it.
  const Visibility& visibility(const StudyCell& cell) const;

  /// Of the worlds with moved furniture only the latest are kept.
  QueryWorld queries(const StudyCell& cell);

  /// Null for a rig that is its own truth. Throws Error if truth and told rig do not fit.
  std::shared_ptr<const ToldRigs> told(const StudyCell& cell);

  /// Null for a cell without [calibration]. Of many that differ only the latest are kept.
  std::shared_ptr<const FreshCalibrations> calibrations(const StudyCell& cell);

 private:
  const Study& study_;
  std::map<std::string, Visibility> visibilities_;
  std::mutex mutex_;
  std::map<std::string, QueryWorld> worlds_;
  std::deque<std::string> changed_keys_;  // oldest first
  std::map<std::string, std::shared_ptr<const FreshCalibrations>> calibrations_;
  std::deque<std::string> calibration_keys_;  // the same
};

}  // namespace vernier::sim::internal
