// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/cli11_fwd.h"

namespace vernier::cli {

/// " (see vernier VERB --help)" for the verb that the command line named, if it named one.
std::string where_help_is(const CLI::App& app);

/// The message for words of the command line that CLI11 left over: the first of them, the verb or
/// option that was probably meant, and where the help is.
std::string unexpected_words(const CLI::App& app);

}  // namespace vernier::cli
