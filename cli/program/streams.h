// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Opens descriptors 0 to 2 where the program was started without them, so that no file gets their
/// number. A missing standard output stays one that cannot be written; lines for a missing standard
/// error are lost.
void open_missing_streams() noexcept;

/// Writes to standard error. What cannot be written is lost: a closed or full standard error
/// changes no result and no exit code.
void say(std::string_view text) noexcept;

/// From then on say() does nothing: for a process beside the one that speaks for all.
void be_silent() noexcept;

/// Writes a result to standard output, completely. Throws Error if that fails; where the reader of
/// a pipe has gone the program ends by SIGPIPE as others do, or throws if that signal is ignored.
void print_result(std::string_view text);

}  // namespace vernier::cli
