// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

/// The result file that `evaluate -o` writes next to the pictures.
inline constexpr const char* evaluation_file = "evaluation.json";

/// A score as JSON; null where a rate is undefined.
Json figures_json(const MatcherScore& score, double time_ms);
Json angles_json(const MatcherScore& score);

/// Means over the scenes in which a number is defined. A scene in which nothing matches leaves all
/// rates undefined, so that no matcher gains by it.
Json mean_of(const std::vector<Json>& scenes);

/// The header and one line of the table.
std::string figures_header();
std::string figures_line(const std::string& pair, const std::string& matcher, const Json& figures);

}  // namespace vernier::cli
