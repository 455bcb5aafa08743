// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/component_test.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "calib/noise/component_tests.h"
#include "cli/program/session.h"

namespace vernier::cli {

Json test_json(const std::optional<ComponentTest>& test) {
  if (!test) return nullptr;
  return {{"likelihood_ratio", test->ratio}, {"p_value", test->p_value}};
}

std::string p_text(const ComponentTest& test) {
  return test.p_value < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.4f}", test.p_value);
}

}  // namespace vernier::cli
