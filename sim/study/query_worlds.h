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
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// Where queries stand and what they see there.
struct QueryWorld {
  std::shared_ptr<const ChangedWorld> changed;  ///< null if nothing has moved
  std::shared_ptr<const QueryPlaces> places;
};

/// The query worlds of a study's cells, made when they are first asked for, from any thread. Of
/// those with moved furniture only the latest are kept.
class QueryWorlds {
 public:
  /// Keeps references to both.
  QueryWorlds(const Study& study, const Visibility& recorded)
      : study_(study), recorded_(recorded) {}

  /// Throws Error, with the world file's name, if no query can be placed.
  QueryWorld of(const ExperimentSettings& settings);

 private:
  QueryWorld make(const ExperimentSettings& settings) const;

  const Study& study_;
  const Visibility& recorded_;
  std::mutex mutex_;
  std::map<std::string, QueryWorld> worlds_;
  std::deque<std::string> changed_keys_;  // oldest first
};

}  // namespace vernier::sim::internal
