// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "cli/program/cli11_fwd.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Checks of options for CLI11: what is wrong with the text, or nothing.

/// CLI::NonNegativeNumber and CLI::PositiveNumber let "nan" and "inf" pass.
std::string finite_and_not_negative(const std::string& text);
std::string finite_and_positive(const std::string& text);
std::string finite(const std::string& text);

/// The name of a PNG file.
std::string png_name(const std::string& text);

std::string not_empty(const std::string& text);

/// Without it -1 would wrap round to the largest seed.
std::string not_negative(const std::string& text);

/// Throws Error for the first of the options that the command line gives: nothing would come of it.
/// `why` says so, such as "a rig file says this itself".
void refuse_options(const CLI::App& verb,
                    std::span<const char* const> options,
                    const std::string& why,
                    const std::string& remedy = "leave it out");

}  // namespace vernier::cli
