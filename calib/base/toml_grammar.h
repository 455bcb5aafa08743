// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// A check of TOML text before toml++ reads it. Not installed.
namespace vernier::internal {

/// What a TOML text may hold. The largest real file is a world: 100,000 segments take 10 MB.
struct TomlLimits {
  std::size_t bytes = 64'000'000;
  std::size_t values = 4'000'000;
  std::size_t depth = 32;  ///< parts of dotted keys, lists and inline tables inside each other
  std::size_t key_bytes = 256;
  std::size_t number_bytes = 100;
  std::size_t text_bytes = 100'000;
  // toml++ looks through all of these for every further one.
  std::size_t dotted_keys = 10'000;   ///< headers such as [a.b] included
  std::size_t lists_of_tables = 500;  ///< different headers [[a]]
};

/// Throws Error("place:line") if `text` is not TOML 1.0, beyond a limit, or has a number that
/// neither a double nor a 64-bit integer can hold. Dates and times are refused: nothing here takes
/// one.
///
/// toml++ 3.3 recurses as deep as its input, and some malformed keys, headers and values bring it
/// to undefined behaviour, so that it may only see text with valid syntax. It still has to find
/// keys that are defined twice.
void check_toml(std::string_view text, const std::string& place, const TomlLimits& limits = {});

}  // namespace vernier::internal
