// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/query_worlds.h"

#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "calib/base/error_place.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/study/study.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

QueryWorld QueryWorlds::make(const ExperimentSettings& settings) const {
  QueryWorld world;
  with_errors_of(study_.file.world, [&] {
    if (settings.sources.moved > 0) {
      world.changed = std::make_shared<const ChangedWorld>(recorded_.world(),
                                                           settings.sources.moved, settings.seed);
    }
    world.places =
        std::make_shared<const QueryPlaces>(world.changed ? world.changed->visibility : recorded_,
                                            settings.protocol, settings.mount.height_m);
    return 0;
  });
  return world;
}

QueryWorld QueryWorlds::of(const ExperimentSettings& settings) {
  const double moved = settings.sources.moved;
  std::string key = fmt::format("{} {}", name(settings.protocol), settings.mount.height_m);
  if (moved > 0) key += fmt::format(" {} {}", moved, settings.seed);
  const std::lock_guard lock(mutex_);
  if (const auto found = worlds_.find(key); found != worlds_.end()) return found->second;
  QueryWorld world = make(settings);
  if (moved > 0) {
    constexpr std::size_t most_changed = 16;
    changed_keys_.push_back(key);
    if (changed_keys_.size() > most_changed) {
      worlds_.erase(changed_keys_.front());
      changed_keys_.pop_front();
    }
  }
  return worlds_.emplace(key, std::move(world)).first->second;
}

}  // namespace vernier::sim::internal
