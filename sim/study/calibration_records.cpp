// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/calibration_records.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "sim/study/grace.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/system_kind.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr int enough = 100;  ///< calibrations of a record

struct MissingRecord {
  std::string key;
  std::shared_ptr<const FreshCalibrations> calibrations;
};

std::vector<MissingRecord> missing_records(const Study& study,
                                           const StudyWork& work,
                                           const StudyRun& run,
                                           const StoredResults& stored,
                                           StudyScenes& scenes) {
  std::vector<MissingRecord> missing;
  std::set<std::string> seen;
  for (std::size_t job = 0; job < work.blocks.size(); ++job) {
    if (work.blocks[job].block != 0) continue;
    const StudyCell& cell = study.file.cells[static_cast<std::size_t>(work.blocks[job].cell)];
    // Of a study of calibrations the trials say it.
    if (!cell.told.calibration || system_kind(cell.system.name).calibrates) continue;
    std::string key = calibration_key(study, cell);
    if (!seen.insert(key).second || stored.notes().count(key) > 0) continue;
    if (static_cast<int>(job % static_cast<std::size_t>(run.shard.count)) != run.shard.index) {
      continue;  // another shard's
    }
    missing.push_back({std::move(key), scenes.calibrations(cell)});
  }
  return missing;
}

}  // namespace

void record_calibrations(const Study& study,
                         const StudyWork& work,
                         const StudyRun& run,
                         const StoredResults& stored,
                         StudyScenes& scenes,
                         std::optional<StudyStore>& store) {
  const std::vector<MissingRecord> missing = missing_records(study, work, run, stored, scenes);
  const int total = enough * static_cast<int>(missing.size());
  std::atomic<int> done = 0;
  const auto tell = [&] {
    if (run.calibration_progress) run.calibration_progress(done, total);
  };
  for (const MissingRecord& record : missing) {
    std::vector<std::shared_ptr<const FreshCalibration>> calibrations(enough);
    std::future<void> computed = std::async(std::launch::async, [&] {
      for_each_index(enough, run.threads, [&](std::size_t draw) {
        if (run.stop.stop_requested()) return;
        calibrations[draw] = record.calibrations->of(static_cast<std::uint32_t>(draw));
        ++done;
      });
    });
    Grace grace;
    while (computed.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
      tell();
      if (!run.ranks || !run.on_stop || !grace.is_over(run.stop.stop_requested())) continue;
      store.reset();
      run.on_stop();
      break;
    }
    computed.get();
    if (run.stop.stop_requested()) return;
    tell();
    const auto [name, note] =
        calibration_note(record.key, record_of(record.calibrations->truth(), calibrations));
    store->set_note(name, note);
  }
}

}  // namespace vernier::sim::internal
