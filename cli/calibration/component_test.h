// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calib/noise/component_tests.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// `likelihood_ratio` and `p_value`; null without a test.
Json test_json(const std::optional<ComponentTest>& test);

/// "p = 0.0123"
std::string p_text(const ComponentTest& test);

}  // namespace vernier::cli
