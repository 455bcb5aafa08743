// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/rig.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

PlacedCamera placed_camera(const std::string& text) {
  std::vector<std::string> notes;
  return parse_mrcal_cameramodel(text, "left.cameramodel", {}, notes);
}

void run_mrcal_cameramodel(std::string_view bytes) {
  const auto camera = accepted([&] { return placed_camera(std::string(bytes)); });
  if (!camera) return;
  // Beside another camera, so that the pose is written too.
  const Rig rig = rig_of({{example_rig("pinhole", 1).cameras[0], {}}, *camera});
  const auto files = accepted([&] { return mrcal_cameramodels(rig); });
  if (!files) return;
  std::vector<PlacedCamera> again;
  for (const ExportedFile& file : *files) again.push_back(placed_camera(file.text));
  require_close(rig, rig_of(again));
}

const Registered registered_mrcal_cameramodel{{"mrcal_cameramodel", 2000, "mrcal",
                                               run_mrcal_cameramodel,
                                               [] { return example_files(mrcal_cameramodels); }}};

}  // namespace
}  // namespace vernier::fuzz
