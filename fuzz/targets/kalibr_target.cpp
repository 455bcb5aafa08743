// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/board/kalibr_target.h"
#include "calib/board_target.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

void run_kalibr_target(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "target.yaml");
  const auto target = accepted([&] { return vernier::internal::read_kalibr_target(file); });
  if (!target) return;
  check_target(*target);
  require(static_cast<int>(target_points(*target).size()) == corner_grid(*target).prod(),
          "a target has the corners of its grid");
}

/// Nothing writes these files: as Kalibr's documentation has them.
std::vector<std::string> kalibr_target_seeds() {
  return {
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n"
      "codeOffset: 0\n",
      "target_type: 'checkerboard' # inner corners\ntargetCols: 6\ntargetRows: 7\n"
      "rowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n",
  };
}

const Registered registered_kalibr_target{
    {"kalibr_target", 1000, "kalibr", run_kalibr_target, kalibr_target_seeds}};

}  // namespace
}  // namespace vernier::fuzz
