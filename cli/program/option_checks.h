// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <span>
#include <string>

#include "cli/program/cli11_fwd.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Option validators for CLI11: return an error message, or an empty string if valid.

/// CLI::NonNegativeNumber and CLI::PositiveNumber accept "nan" and "inf".
std::string finite_and_not_negative(const std::string& text);
std::string finite_and_positive(const std::string& text);
std::string finite(const std::string& text);

/// The name of a PNG or an SVG file.
std::string png_name(const std::string& text);
std::string svg_name(const std::string& text);

std::string not_empty(const std::string& text);

/// Makes options of a verb name files that can be written, or a folder of such files. A fault is
/// found with the command line, before anything is read or computed: throws Error as the writers of
/// files do.
void check_files_written(CLI::App& verb, std::initializer_list<const char*> options);
void check_folder_written(CLI::App& verb, const char* option);

/// Makes every numeric option of a program and its verbs take plain decimal numbers only. CLI11
/// would read 010 as 8, 1e3 as 1 and 18446744073709551616 as the largest seed, wrap -1 around, and
/// take blanks, quotes, hexadecimal numbers, "nan" and "inf".
void check_numbers(CLI::App& app);

/// Throws Error for an option or argument that is given, and empty: a shell's variable that is not
/// set would otherwise count as not given.
void refuse_empty_values(const CLI::App& app);

/// Throws Error for the first of the options given on the command line, because it would have no
/// effect. `why` is the reason, such as "the rig file already defines it".
void refuse_options(const CLI::App& verb,
                    std::span<const char* const> options,
                    const std::string& why,
                    const std::string& remedy = "leave it out");

}  // namespace vernier::cli
