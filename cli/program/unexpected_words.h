// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/cli11_fwd.h"

namespace vernier::cli {

/// The message for a command line that CLI11 refuses, and where the help is. Words that it left
/// over go first, with the verb or option that was probably meant: something that is required may
/// be missing because it is misspelt.
std::string usage_fault(const CLI::App& app, const CLI::ParseError& error);

}  // namespace vernier::cli
