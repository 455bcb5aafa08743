// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/example_stores.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "sim/study/ceiling.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::sim::internal;

/// Of one cell, with as many queries of its ceiling as it has trials.
const Study& study() {
  static const Study one = [] {
    Study study;
    study.file.trials = 12;
    study.file.cells.resize(1);
    return study;
  }();
  return one;
}

/// Two parts of a world ceiling, as two runs have stored them.
void run_ceiling_notes(std::string_view bytes) {
  static const std::string key = ceiling_key(study(), study().file.cells[0]);
  const auto [first, second] = split_at_line(bytes, right_file);
  const StoreNotes notes{{key + " part a", std::string(first)},
                         {key + " part b", std::string(second)}};
  const auto queries = accepted([&] { return noted_queries(study(), notes, key); });
  if (!queries) return;
  require(noted_queries(study(), {ceiling_part(key, *queries)}, key) == *queries,
          "what is written is read as the same");
  if (const auto ceiling = noted_ceiling(study(), notes, key)) {
    const auto is_share = [](double value) { return value >= 0 && value <= 1; };
    require(is_share(ceiling->success) && is_share(ceiling->unaliased), "a ceiling is a share");
  }
}

/// What a note says became of calibrations.
void run_calibration_note(std::string_view bytes) {
  const auto read = [](const StoreNotes::value_type& note) {
    return noted_calibrations({note}, note.first).value();
  };
  const auto record = accepted([&] { return read({"calibration", std::string(bytes)}); });
  if (!record) return;
  const CalibrationRecord again = read(calibration_note("calibration", *record));
  require(again.calibrations == record->calibrations && again.failed == record->failed &&
              again.doubtful == record->doubtful,
          "counts are kept");
  require(again.why_failed == record->why_failed && again.why_doubtful == record->why_doubtful,
          "reasons are kept");
  require(same(again.range_m, record->range_m) &&
              same(again.depth_error_m, record->depth_error_m) &&
              same(again.depth_sd_m, record->depth_sd_m),
          "depths are kept");
  require(record->failed >= 0 && record->failed <= record->calibrations && record->doubtful >= 0 &&
              record->doubtful <= record->calibrations,
          "those that failed are among all");
}

/// Those of the example whose key begins so.
std::vector<std::string> notes_of(std::string_view key) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : example_notes()) {
    if (name.starts_with(key)) texts.push_back(value);
  }
  return texts;
}

std::vector<std::string> ceiling_notes_seeds() {
  const std::string part = notes_of("ceiling").at(0);
  return {part, part + "\n---\n" + part,
          ceiling_part("", QueryCeilings(12, QueryCeiling{0.25, false})).second};
}

std::vector<std::string> calibration_note_seeds() { return notes_of("calibration"); }

const Registered registered_ceiling_notes{
    {"ceiling_notes", 300, "notes", run_ceiling_notes, ceiling_notes_seeds}};
const Registered registered_calibration_note{
    {"calibration_note", 500, "notes", run_calibration_note, calibration_note_seeds}};

}  // namespace
}  // namespace vernier::fuzz
