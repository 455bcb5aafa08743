// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

/// What `evaluate -o` leaves in a folder, beside its pictures.
inline constexpr const char* evaluation_file = "evaluation.json";

/// A score as JSON; null where there is nothing to share.
Json figures_json(const MatcherScore& score, double time_ms);
Json angles_json(const MatcherScore& score);

/// Means over scenes of the numbers in their JSON; null where one is.
Json mean_of(const std::vector<Json>& scenes);

/// The table's first line, and one of it.
std::string figures_header();
std::string figures_line(const std::string& pair, const std::string& matcher, const Json& figures);

}  // namespace vernier::cli
