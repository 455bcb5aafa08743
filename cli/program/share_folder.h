// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Path of a shipped file, such as "worlds/workshop.world.toml": searched in the folder named by
/// the environment variable VERNIER_SHARE, then in share/vernier next to the program (build folder)
/// or next to its bin folder (installation). Empty if not found.
std::filesystem::path shipped_file(const std::filesystem::path& name);

/// Path of a shipped script, searched likewise but only at absolute paths, so that a script in the
/// working directory is never run. Returns the name if not found.
std::filesystem::path shipped_script(const std::string& name);

/// The file of a world or rig given by a shipped name ("workshop", "nominal") or a path; a relative
/// path is resolved against `beside` first. Throws Error, listing the shipped names, if not found.
std::filesystem::path find_world(const std::string& name, const std::filesystem::path& beside = "");
std::filesystem::path find_rig(const std::string& name, const std::filesystem::path& beside = "");

/// The existing folders of shipped data, in search order.
std::vector<std::filesystem::path> share_folders();

}  // namespace vernier::cli
