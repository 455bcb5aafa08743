// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calib/noise/board_tests.h"
#include "calib/noise/component_tests.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// `likelihood_ratio` or `chi2`, and `p_value`; null without a test.
Json test_json(const std::optional<ComponentTest>& test);
Json test_json(const std::optional<BoardTest>& test);

/// "0.12 mm", or "0.50 mm along the baseline, 0.12 mm across it" where that is not 0.
std::string motion_words(double motion_m, double motion_baseline_m);

/// "p = 0.0123"
std::string p_text(double p_value);

}  // namespace vernier::cli
