// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Throws Error where writing `output` would replace one of the files that were read, by whatever
/// name or link. Inputs that are not there are passed over.
void check_output_is_not_input(const std::vector<std::filesystem::path>& inputs,
                               const std::filesystem::path& output);

/// Throws Error where the file of `option` is, by whatever name, the file `other` too.
void check_different(const std::string& option,
                     const std::filesystem::path& file,
                     const std::filesystem::path& other);

}  // namespace vernier::cli
