// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace vernier::cli {

/// Where the shipped worlds, rigs and page are: the environment variable VERNIER_SHARE, else
/// share/vernier beside the program (in a build folder) or beside its bin folder (installed).
/// Empty where there is none.
std::filesystem::path share_folder();

/// The file of a world or rig given by a shipped name ("workshop", "nominal") or a path; a relative
/// path is tried from `beside` first. Throws Error, listing the shipped names, where there is none.
std::filesystem::path find_world(const std::string& name, const std::filesystem::path& beside = "");
std::filesystem::path find_rig(const std::string& name, const std::filesystem::path& beside = "");

}  // namespace vernier::cli
