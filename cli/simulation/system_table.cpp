// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/system_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "cli/program/text_table.h"
#include "sim/study/cell_summary.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {

std::string significant(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.3g}", value);
}

std::string measured_table(const StudyResults& results, std::vector<TextColumn> rows) {
  const SystemSettings& system = results.cells[0].cell.system;
  if (system.measured_names.empty()) return {};
  const SystemKind& kind = system_kind(system.name);
  for (std::size_t i = 0; i < system.measured_names.size(); ++i) {
    const std::string& name = system.measured_names[i];
    const bool by_rms = std::any_of(
        kind.measured.begin(), kind.measured.end(),
        [&](const MeasuredQuantity& of) { return of.name == name && of.of_either_sign; });
    TextColumn column{by_rms ? "rms " + name : name, {}};
    for (const CellResult& cell : results.cells) {
      const std::vector<MeasuredSummary>& all = cell.summary.measured;
      const MeasuredSummary measured = i < all.size() ? all[i] : MeasuredSummary{};
      column.cells.push_back(significant(by_rms ? measured.rms : measured.median));
    }
    rows.push_back(std::move(column));
  }
  return "\nmeasured, medians (rms where named so) over the answered trials:\n" +
         text_table(std::move(rows));
}

bool uses_told_rigs(const SystemKind& kind) {
  return kind.tells_rigs || kind.sources == SourcesUsed::all;
}

std::string limit_text(const StudyFile& study) {
  const std::vector<StudyCell>& cells = study.cells;
  const double limit = cells[0].system.success_error;
  const bool is_one = std::all_of(cells.begin(), cells.end(), [&](const StudyCell& cell) {
    return cell.system.success_error == limit;
  });
  const std::string& unit = system_of(study).unit;
  return is_one ? fmt::format("{:g}{}{}", limit, unit.empty() ? "" : " ", unit)
                : "system.success_error";
}

std::string system_conditions(const Study& study, const std::string& worlds) {
  const SystemKind& kind = system_of(study.file);
  const std::string blocks = "blocks of " + counted(study.file.trials_per_block, "trial");
  return (kind.uses("world") ? fmt::format("world {}\n", worlds) : "") +
         fmt::format("system {}; success: answered, {} at most {}\n", kind.name, kind.error_title,
                     limit_text(study.file)) +
         (study.file.interval_width
              ? fmt::format("interval: confidence sequence over {}, to {} wide\n", blocks,
                            *study.file.interval_width)
              : fmt::format("interval: Wilson's with Student's t, clustered by {}\n", blocks));
}

}  // namespace vernier::cli
