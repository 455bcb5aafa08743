// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>

#include "calib/board_observations.h"
#include "cli/program/session.h"
#include "sim/sources.h"
#include "sim/study/cell_summary.h"
#include "sim/study/reliability.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::cli {
namespace {

/// Failed calibrations are results; of another system that fails nothing is to be trusted, nor
/// where most calibrations are doubted.
void add_failed_system(const CellResult& cell, StudyDoubts& found) {
  const CellSummary& s = cell.summary;
  const SystemKind& kind = system_kind(cell.cell.system.name);
  const auto tell = [&](int trials, const char* what, const std::string& why, bool is_result) {
    const std::string text =
        fmt::format("{} {} in {} of {} trials of cell \"{}\"{}{}", kind.noun, what, trials,
                    s.trials, cell.cell.label, why.empty() ? "" : ", the first by: ", why);
    is_result ? found.warnings.push_back(text) : found.doubts.push_back(text);
  };
  const bool calibrations_fail = cell.calibrations && cell.calibrations->failed > 0;
  if (s.failed > 0) {
    tell(s.failed, "failed", s.why_failed,
         calibrations_fail || (kind.calibrates && s.failed < s.trials));
  }
  if (kind.calibrates && 2 * s.unsure > s.trials - s.failed) {
    tell(s.unsure, "is doubtful", s.why_unsure, false);
  }
}

/// Says in which cells trials have failed: a reason not to trust the results, but a result where a
/// calibration has.
void add_failed_trials(const StudyResults& results, StudyDoubts& found) {
  for (const CellResult& cell : results.cells) {
    if (!cell.cell.system.is_localiser()) {
      add_failed_system(cell, found);
      continue;
    }
    const int failed = cell.summary.failed;
    if (failed == 0) continue;
    const SourceSettings& sources = cell.cell.experiment.sources;
    if (cell.calibrations && cell.calibrations->failed > 0) {  // a result, and the table has it
      found.warnings.push_back(
          fmt::format("{} of {} trials of cell \"{}\" have failed: their calibrations, or "
                      "those of their maps, did",
                      failed, cell.summary.trials, cell.cell.label));
      continue;
    }
    found.doubts.push_back(fmt::format(
        "{} failed in {} of {} trials of cell \"{}\"; {}",
        sources.command.empty() && sources.own.empty() ? "the localiser"
                                                       : "the localiser or a source of error",
        failed, cell.summary.trials, cell.cell.label,
        sources.calibration > 0
            ? fmt::format("vernier localise with the same settings says why, unless they were told "
                          "a rig that no cameras can have (psi_c = {:g})",
                          sources.calibration)
            : "vernier localise with the same settings says why"));
  }
}

/// Whether the robot saw too little in every trial for a localiser to begin.
bool sees_nothing(const CellResult& cell) {
  const CellSummary& s = cell.summary;
  return cell.cell.system.is_localiser() && s.trials > 0 && s.unseen == s.trials;
}

/// Says in which cells nothing that localises was seen in any trial; where that is so in all of
/// them, a reason not to trust them.
void add_unseen_worlds(const StudyResults& results, StudyDoubts& found) {
  const auto first = std::find_if(results.cells.begin(), results.cells.end(), sees_nothing);
  if (first == results.cells.end()) return;
  const auto cells = std::count_if(first, results.cells.end(), sees_nothing);
  const std::string text = fmt::format(
      "too little was seen in every trial of cell \"{}\"{} to localise the robot: check the route, "
      "the world, the rig and the camera's height (vernier simulate --world shows what is seen)",
      first->cell.label, cells > 1 ? fmt::format(" and of {} more", cells - 1) : "");
  const bool all = static_cast<std::size_t>(cells) == results.cells.size();
  all ? found.doubts.push_back(text) : found.warnings.push_back(text);
}

/// The error rate of its answers that a method states: its threshold or, of a program, which has
/// none, the mean of what it stated of them.
double stated_error_rate(const CellResult& cell) {
  if (cell.cell.experiment.method != "program") {
    return cell.cell.experiment.localiser.max_error_rate;
  }
  return cell.stated.mean_of_answers();
}

/// Says in which cells more answers are wrong than the localiser states, by more than chance: at
/// least twice as many at 98 % confidence.
void add_understated_errors(const StudyResults& results, StudyDoubts& found) {
  std::string first;
  int cells = 0;
  for (const CellResult& cell : results.cells) {
    const CellSummary& s = cell.summary;
    if (cell.stated.reliability().empty()) continue;  // states nothing
    const int answers = static_cast<int>(std::lround(s.coverage * s.trials));
    const int wrong = answers - static_cast<int>(std::lround(s.success * s.trials));
    const double stated = stated_error_rate(cell);
    if (!understates_errors(wrong, answers, stated)) continue;
    if (++cells > 1) continue;
    first =
        fmt::format("{} of {} answers of cell \"{}\" are wrong, where the localiser states {:g} %",
                    wrong, answers, cell.cell.label, 100 * stated);
  }
  if (cells == 0) return;
  found.warnings.push_back(
      fmt::format("{}{}: what it states does not hold there, as in a building that repeats or is "
                  "bare, or for a "
                  "rig that is far off",
                  first, cells > 1 ? fmt::format(", and so in {} more cells", cells - 1) : ""));
}

/// Says which cells have not a single calibration to tell: a reason not to trust them.
void add_failed_calibrations(const StudyResults& results, StudyDoubts& found) {
  for (const CellResult& cell : results.cells) {
    const auto& record = cell.calibrations;
    if (!record || record->calibrations == 0) continue;
    if (cell.cell.experiment.sources.calibration == 0) continue;  // it was told the truth
    const int used = record->calibrations - record->failed;
    if (used == 0) {
      found.doubts.push_back(
          fmt::format("cell \"{}\": all {} calibrations failed, the first by: {}", cell.cell.label,
                      record->calibrations, record->why_failed));
    } else if (2 * record->doubtful > used) {
      found.doubts.push_back(
          fmt::format("cell \"{}\": {} of {} calibrations are doubtful, the first by: {}",
                      cell.cell.label, record->doubtful, used, record->why_doubtful));
    }
  }
}

/// Doubts cells whose calibrations share most of their real views with one another, and with the
/// true rig where it is of all of them: they err by less than fresh ones.
void add_shared_views(const Study& study, StudyDoubts& found) {
  if (!study.corners) return;
  const auto frames = static_cast<int>(frames_of(*study.corners).size());
  std::set<int> told;
  for (const StudyCell& cell : study.file.cells) {
    if (!cell.told.calibration) continue;
    const int views = cell.told.calibration->views;
    if (2 * views <= frames || !told.insert(views).second) continue;
    found.doubts.push_back(fmt::format(
        "calibrations from {} of the same {} frames share most of them: their error, against a rig "
        "calibrated from all of them, is about {:.2f} times that of fresh views; take at most half",
        views, frames, std::sqrt(1 - static_cast<double>(views) / frames)));
  }
}

/// Says which programs of the user's own were others at the run.
void add_changed_programs(const StudyResults& results, StudyDoubts& found) {
  for (const std::string& command : results.changed_programs) {
    found.warnings.push_back(
        fmt::format("the files of the program \"{}\" were others when the study ran, or "
                    "are not found from here; the results are those of that run, and the study "
                    "would begin anew",
                    command));
  }
}

}  // namespace

StudyDoubts doubts_of(const Study& study, const StudyResults& results) {
  StudyDoubts found;
  add_failed_trials(results, found);
  add_shared_views(study, found);
  add_failed_calibrations(results, found);
  add_unseen_worlds(results, found);
  add_understated_errors(results, found);
  add_changed_programs(results, found);
  return found;
}

void tell(const StudyDoubts& found, Session& session) {
  for (const std::string& warning : found.warnings) session.warn(warning);
  for (const std::string& doubt : found.doubts) session.add_trust_warning(doubt);
}

void tell_stored(const StudyDoubts& found, const StudyResults& results, Session& session) {
  for (const std::string& doubt : found.doubts) session.warn(doubt);
  for (const std::string& warning : found.warnings) session.warn(warning);
  if (results.blocks_done < results.blocks_total) {
    session.add_trust_warning(fmt::format("the study is not finished: {} of {} blocks",
                                          results.blocks_done, results.blocks_total));
  }
}

}  // namespace vernier::cli
