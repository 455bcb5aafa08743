// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/rig_estimate.h"
#include "cli/program/namespaces.h"
#include "cli/program/rig_input.h"

namespace vernier::cli {

inline constexpr const char* written_rig_format_names =
    "vernier, mrcal, opencv, kalibr, ros, colmap";

/// The format of `--to`. Throws Error for one that is unknown or only read.
RigFormat written_format(const std::string& name);

/// The format of an output from its name: .json, .cameramodel, cameras.txt. Throws Error for all
/// others.
RigFormat output_format(const std::filesystem::path& output);

/// The file contents of a rig. A single file is named `output` unless that is a folder: an existing
/// one, or a name with a trailing slash.
std::vector<std::pair<std::filesystem::path, std::string>> files_of(
    RigFormat format, const RigEstimate& estimate, const std::filesystem::path& output);

/// The information that `format` cannot store, one line each.
std::vector<std::string> lost(RigFormat format, const RigEstimate& estimate);

}  // namespace vernier::cli
