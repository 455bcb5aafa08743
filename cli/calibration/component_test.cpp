// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/component_test.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "calib/noise/board_tests.h"
#include "calib/noise/component_tests.h"
#include "cli/program/session.h"

namespace vernier::cli {

Json test_json(const std::optional<ComponentTest>& test) {
  if (!test) return nullptr;
  return {{"likelihood_ratio", test->ratio}, {"p_value", test->p_value}};
}

Json test_json(const std::optional<BoardTest>& test) {
  if (!test) return nullptr;
  return {{"chi2", test->chi2}, {"p_value", test->p_value}};
}

std::string motion_words(double motion_m, double motion_baseline_m) {
  if (!(motion_baseline_m > 0)) return fmt::format("{:.2f} mm", 1e3 * motion_m);
  return fmt::format("{:.2f} mm along the baseline, {:.2f} mm across it", 1e3 * motion_baseline_m,
                     1e3 * motion_m);
}

std::string p_text(double p_value) {
  return p_value < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.4f}", p_value);
}

}  // namespace vernier::cli
