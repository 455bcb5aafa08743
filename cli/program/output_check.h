// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Throws Error if writing `output` would overwrite an input file, also through a link. Missing
/// inputs are ignored, and an output without a name.
void check_output_is_not_input(const std::vector<std::filesystem::path>& inputs,
                               const std::filesystem::path& output);

/// Throws Error if the file of `option` and `other` are the same file, also through a link.
void check_different(const std::string& option,
                     const std::filesystem::path& file,
                     const std::filesystem::path& other);

}  // namespace vernier::cli
