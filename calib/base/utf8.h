// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vernier::internal {

/// The first byte that is not part of valid UTF-8; npos if there is none.
std::size_t first_bad_utf8(std::string_view text);

/// The bytes of the UTF-8 character at `at`; 0 if none is there, or it is not valid.
std::size_t utf8_length(std::string_view text, std::size_t at);

/// Line of a byte of a text, from 1.
std::size_t line_of(std::string_view text, std::size_t byte);

/// Throws Error("place:line") if the text is longer than `most` bytes, is not UTF-8, or contains a
/// zero byte. `what` is the format, such as "a JSON file".
void check_text(std::string_view text,
                const std::string& place,
                const std::string& what,
                std::size_t most_bytes);

}  // namespace vernier::internal
