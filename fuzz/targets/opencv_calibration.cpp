// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/formats/opencv_calibration_file.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_opencv_calibration(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "opencv_calibration.yaml");
  const auto imported = accepted(
      [&] { return read_opencv_calibration({file}, {.size_px = Eigen::Vector2i(640, 480)}); });
  if (!imported) return;
  const auto files = accepted([&] { return opencv_calibration(imported->rig); });
  if (!files) return;
  input_file(files->front().text, "opencv_calibration.yaml");
  require_close(imported->rig,
                read_opencv_calibration({file}, {.size_px = Eigen::Vector2i(640, 480)}).rig);
}

const Registered registered_opencv_calibration{{"opencv_calibration", 4000, "opencv",
                                                run_opencv_calibration,
                                                [] { return example_files(opencv_calibration); }}};

}  // namespace
}  // namespace vernier::fuzz
