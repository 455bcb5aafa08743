// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

namespace vernier::cli {

/// The line about it, without the program's name.
inline constexpr const char* out_of_memory =
    "out of memory; allow it more (ulimit -v), give a smaller input, or use fewer threads";

/// Whether an exception says that memory, or threads for want of it, could not be had.
bool is_out_of_memory(const std::exception& fault) noexcept;

/// Such an exception where none can be caught, as in another library's thread, ends the program
/// with that line and exit code 2 instead of an abort. Temporary files are removed.
void watch_memory() noexcept;

}  // namespace vernier::cli
