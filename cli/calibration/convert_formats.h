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

/// The format of an input by its name and, for .yaml and .yml, its keys. Throws Error where these
/// do not say.
RigFormat input_format(const std::filesystem::path& input);

/// The format of an output by its name: .json, .cameramodel, cameras.txt. Throws Error for all
/// others.
RigFormat output_format(const std::filesystem::path& output);

/// What was read, with what is to be said of it.
struct ReadRig {
  RigEstimate estimate;
  std::vector<std::string> notes;
};

ReadRig read_rig_as(RigFormat format,
                    const std::vector<std::filesystem::path>& inputs,
                    const ImportOptions& options);

/// The files of a rig, one of them named by `output` where one is enough and it is no folder. A
/// folder is an existing one, or a name that ends in a slash.
std::vector<std::pair<std::filesystem::path, std::string>> files_of(
    RigFormat format, const RigEstimate& estimate, const std::filesystem::path& output);

/// What `format` has no place for, one line each.
std::vector<std::string> lost(RigFormat format, const RigEstimate& estimate);

}  // namespace vernier::cli
