// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_scenes.h"

#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "calib/base/error_place.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/told_settings.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/told/scaled_error.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

std::string visibility_key(const StudyCell& cell) {
  return fmt::format("{} {}", static_cast<int>(cell.visibility), cell.world);
}

/// Errors about a key of [calibration] name its line.
template <class Work>
auto naming_lines(const StudyFile& file, Work&& work) {
  try {
    return work();
  } catch (const Error& error) {
    const std::string key = error.place().substr(0, error.place().find(' '));
    if (!key.starts_with("calibration.")) throw;
    throw error_of(place_of(file, key), error);
  }
}

}  // namespace

StudyScenes::StudyScenes(const Study& study) : study_(study) {
  for (const StudyCell& cell : study.file.cells) {
    if (cell.experiment.method == "corners" && world_of(study, cell).corners.empty()) {
      throw Error(
          place_of(study.file, "localiser.method"),
          "localiser \"corners\" looks for corners, and the world " + cell.world + " has none",
          "add corners to the world (vernier world make has some), or take another method");
    }
    const std::string key = visibility_key(cell);
    if (visibilities_.count(key) > 0) continue;
    with_errors_of(cell.world, [&] {
      return visibilities_.try_emplace(key, world_of(study, cell), cell.visibility).second;
    });
  }
}

const Visibility& StudyScenes::visibility(const StudyCell& cell) const {
  return visibilities_.at(visibility_key(cell));
}

QueryWorld StudyScenes::queries(const StudyCell& cell) {
  const ExperimentSettings& settings = cell.experiment;
  const double moved = settings.sources.moved;
  std::string key = fmt::format("{} {} {}", name(settings.protocol), settings.mount.height_m,
                                visibility_key(cell));
  if (moved > 0) key += fmt::format(" {} {}", moved, settings.seed);
  const Visibility& recorded = visibility(cell);
  const std::lock_guard lock(mutex_);
  if (const auto found = worlds_.find(key); found != worlds_.end()) return found->second;
  QueryWorld world;
  with_errors_of(cell.world, [&] {
    if (moved > 0) {
      world.changed = std::make_shared<const ChangedWorld>(recorded.world(), moved, settings.seed);
    }
    world.places =
        std::make_shared<const QueryPlaces>(world.changed ? world.changed->visibility : recorded,
                                            settings.protocol, settings.mount.height_m);
    return 0;
  });
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

std::shared_ptr<const FreshCalibrations> StudyScenes::calibrations(const StudyCell& cell) {
  if (!cell.told.calibration) return nullptr;
  const std::string key = calibration_key(study_, cell);
  const std::lock_guard lock(mutex_);
  if (const auto found = calibrations_.find(key); found != calibrations_.end()) {
    return found->second;
  }
  const auto made = naming_lines(study_.file, [&] {
    return std::make_shared<const FreshCalibrations>(study_.rig.rig, *cell.told.calibration,
                                                     cell.experiment.seed, study_.corners);
  });
  constexpr std::size_t most_kept = 30;  // those in use stay with the blocks that use them
  calibration_keys_.push_back(key);
  if (calibration_keys_.size() > most_kept) {
    calibrations_.erase(calibration_keys_.front());
    calibration_keys_.pop_front();
  }
  return calibrations_.emplace(key, made).first->second;
}

std::shared_ptr<const ToldRigs> StudyScenes::told(const StudyCell& cell) {
  const double psi_c = cell.experiment.sources.calibration;
  if (cell.told.calibration) {
    return naming_lines(study_.file, [&] { return calibrated_rigs(calibrations(cell), psi_c); });
  }
  if (cell.told.truth.empty()) return nullptr;
  const std::string& file = cell.told.file;
  const RigEstimate& told = study_.told_rigs.at(file).estimate;
  if (cell.told.error == ToldSettings::Error::given) {
    return given_rig(study_.rig.rig, told.rig, psi_c, file);
  }
  check_same_cameras(study_.rig.rig, told.rig, file);
  if (psi_c == 0) return given_rig(study_.rig.rig, told.rig, 0, file);  // needs no covariance
  return drawn_rigs(study_.rig.rig, required_covariance(told, file), psi_c, cell.experiment.seed,
                    file);
}

}  // namespace vernier::sim::internal
