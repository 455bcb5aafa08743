// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/example_stores.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_database.h"
#include "sim/study/study_keys.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::fuzz {

using localise::LocalisationStatus;
using sim::TrialResult;
using namespace sim::internal;

std::vector<TrialResult> example_trials(int block) {
  std::vector<TrialResult> trials(2);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    TrialResult& trial = trials[i];
    trial.trial = static_cast<std::uint32_t>(2 * block) + static_cast<std::uint32_t>(i);
    trial.truth = {1.0 / 3, -2.0 / 7, 0.1};
    trial.status = i == 0 ? LocalisationStatus::answered : LocalisationStatus::tie;
    trial.error = trial.node_error_m = trial.heading_error_rad = i == 0 ? 0.125 : std::nan("");
    trial.lines = 12;
    trial.score = 4.5;
    if (block == 0) continue;  // one of another system than a localiser
    trial.limit = 0.05;
    trial.measured = {0.5, std::nan("")};
    trial.failure = "says why";
  }
  return trials;
}

StoreNotes example_notes() {
  const CalibrationRecord record{100,          2, 1,    "too few views",
                                 "bent board", 5, 0.02, std::numeric_limits<double>::quiet_NaN()};
  return {{"command", "vernier study run"},
          ceiling_part("ceiling 3 world rig near_path",
                       {QueryCeiling{0.5, false}, std::nullopt, QueryCeiling{1, true}}),
          calibration_note("calibration 2.2 rig 1", record)};
}

void make_small_pages(const std::filesystem::path& file) {
  Database::to_write(file).run("PRAGMA page_size = 512; VACUUM");
}

void require_same(const std::vector<TrialResult>& a, const std::vector<TrialResult>& b) {
  require(a.size() == b.size(), "the number of trials is kept");
  const auto same_pose = [](const localise::Pose2D& p, const localise::Pose2D& q) {
    return same(p.x_m, q.x_m) && same(p.y_m, q.y_m) && same(p.heading_rad, q.heading_rad);
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    const TrialResult &s = a[i], &t = b[i];
    require(s.trial == t.trial && s.status == t.status && s.lines == t.lines &&
                s.corners == t.corners && s.corner_mismatches == t.corner_mismatches &&
                s.looks == t.looks,
            "the counts of trials are kept");
    require(
        same_pose(s.truth, t.truth) && same_pose(s.answer, t.answer) && same_pose(s.node, t.node),
        "the poses of trials are kept");
    require(same(s.error, t.error) && same(s.node_error_m, t.node_error_m) &&
                same(s.heading_error_rad, t.heading_error_rad) && same(s.score, t.score) &&
                same(s.runner_up, t.runner_up) && same(s.cpu_ms, t.cpu_ms) &&
                same(s.wall_ms, t.wall_ms) && same(s.probability, t.probability) &&
                same(s.limit, t.limit),
            "the figures of trials are kept");
    require(s.failure == t.failure && s.measured.has_value() == t.measured.has_value() &&
                (!s.measured ||
                 std::equal(s.measured->begin(), s.measured->end(), t.measured->begin(),
                            t.measured->end(), [](double p, double q) { return same(p, q); })),
            "what trials of other systems say is kept");
  }
}

void require_kept(const StoreContent& a, const StoreContent& b) {
  for (const auto& [key, value] : a.notes) {
    require(b.notes.count(key) == 1 && b.notes.at(key) == value, "notes are kept");
  }
  for (const StoredBlock& block : a.blocks) {
    const auto kept = std::find_if(b.blocks.begin(), b.blocks.end(), [&](const StoredBlock& other) {
      return other.cell == block.cell && other.block == block.block;
    });
    require(kept != b.blocks.end(), "blocks are kept");
    require_same(block.trials, kept->trials);
  }
}

void require_same(const StoreContent& a, const StoreContent& b) {
  require(a.blocks.size() == b.blocks.size(), "the number of blocks is kept");
  require_kept(a, b);
}

}  // namespace vernier::fuzz
