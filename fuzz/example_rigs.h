// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"

namespace vernier::fuzz {

/// Cameras left, right, camera2 … of a lens model, with distortion where it has any: for seeds.
Rig example_rig(const std::string& model, int cameras);

/// For every lens model and one to three cameras, what `write` gives: one text a file. Models that
/// it refuses are left out.
std::vector<std::string> example_files(
    std::vector<vernier::internal::ExportedFile> (*write)(const Rig&));

}  // namespace vernier::fuzz
