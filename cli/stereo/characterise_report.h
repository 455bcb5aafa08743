// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"
#include "sim/sources.h"
#include "sim/sources/measured_sources.h"

namespace vernier::cli {

/// Results of `vernier characterise`.
struct CharacteriseReport {
  MeasuredSources sources;
  std::vector<MeasuredSources> each;  ///< one per pair, without intervals
  ShiftMode mode = ShiftMode::common;
  std::string matcher;
};

/// {"value": …, "interval_95": […, …], "n": …}
Json measured_json(const MeasuredValue& measured);

Json report_json(const CharacteriseReport& report);
std::string report_text(const CharacteriseReport& report);

}  // namespace vernier::cli
