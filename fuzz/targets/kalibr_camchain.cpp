// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/formats/kalibr_camchain.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_kalibr_camchain(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "kalibr_camchain.yaml");
  const auto imported = accepted([&] { return read_kalibr_camchain(file); });
  if (!imported) return;
  const auto files = accepted([&] { return kalibr_camchain(imported->rig); });
  if (!files) return;
  input_file(files->front().text, "kalibr_camchain.yaml");
  require_close(imported->rig, read_kalibr_camchain(file).rig);
}

const Registered registered_kalibr_camchain{{"kalibr_camchain", 3000, "kalibr", run_kalibr_camchain,
                                             [] { return example_files(kalibr_camchain); }}};

}  // namespace
}  // namespace vernier::fuzz
