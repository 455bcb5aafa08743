// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig_estimate.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// The formats of `convert`.
enum class RigFormat { vernier, mrcal, opencv, kalibr, ros, colmap };

inline constexpr const char* rig_format_names = "vernier, mrcal, opencv, kalibr, ros, colmap";
std::string_view name(RigFormat format);
/// Throws Error (`option`) for a name that is none of the above.
RigFormat rig_format(const std::string& name, const std::string& option);

/// The format of an input from its name and, for .yaml and .yml, its keys. Throws Error if
/// undetermined.
RigFormat input_format(const std::filesystem::path& input);

/// The format of an output from its name: .json, .cameramodel, cameras.txt. Throws Error for all
/// others.
RigFormat output_format(const std::filesystem::path& output);

/// The rig that was read, with notes for the user.
struct ReadRig {
  RigEstimate estimate;
  std::vector<std::string> notes;
};

ReadRig read_rig_as(RigFormat format,
                    const std::vector<std::filesystem::path>& inputs,
                    const ImportOptions& options);

/// The file contents of a rig. A single file is named `output` unless that is a folder: an existing
/// one, or a name with a trailing slash.
std::vector<std::pair<std::filesystem::path, std::string>> files_of(
    RigFormat format, const RigEstimate& estimate, const std::filesystem::path& output);

/// The information that `format` cannot store, one line each.
std::vector<std::string> lost(RigFormat format, const RigEstimate& estimate);

}  // namespace vernier::cli
