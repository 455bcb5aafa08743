// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Something that ships with the program, "worlds/workshop.world.toml" say: in the folder that the
/// environment variable VERNIER_SHARE names, else in share/vernier beside the program (in a build
/// folder) or beside its bin folder (installed). Empty where neither has it.
std::filesystem::path shipped_file(const std::filesystem::path& name);

/// A script that ships with the program, likewise, but only by an absolute path: what happens to
/// lie in the working directory is never run. Where there is none, the name.
std::filesystem::path shipped_script(const std::string& name);

/// The file of a world or rig given by a shipped name ("workshop", "nominal") or a path; a relative
/// path is tried from `beside` first. Throws Error, listing the shipped names, where there is none.
std::filesystem::path find_world(const std::string& name, const std::filesystem::path& beside = "");
std::filesystem::path find_rig(const std::string& name, const std::filesystem::path& beside = "");

/// The folders themselves, the first one first; those that are there.
std::vector<std::filesystem::path> share_folders();

}  // namespace vernier::cli
