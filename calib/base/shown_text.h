// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Input as it is shown in messages: short, on one line, harmless to a terminal.
namespace vernier::internal {

/// The text in double quotes: at most 60 characters of it, with "…" where it was cut.
std::string in_quotes(std::string_view text);

/// The same without quotes, for keys that are part of a place.
std::string shortened(std::string_view text);

/// "1 view", "2 views"
std::string counted(std::int64_t count, std::string_view noun);

/// "a, b or c"
std::string alternatives(std::span<const std::string> words);

/// A message as one line of at most `most` bytes, cut in the middle if it is longer. Control
/// characters, characters that turn the direction of writing, and bytes that are not UTF-8 are
/// written as \x1b.
std::string printable(std::string_view message, std::size_t most = 560);

}  // namespace vernier::internal
