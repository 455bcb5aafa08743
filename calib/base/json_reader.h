// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

/// The one reader of JSON from outside. Not installed.
namespace vernier::internal {

/// What a JSON text may hold. The largest real file is a rig with its evidence: one million pairs
/// of points take 100 MB and 5 million values, 6 levels deep.
struct JsonLimits {
  std::size_t bytes = 256'000'000;
  std::size_t values = 16'000'000;  ///< numbers, texts, lists and objects together
  std::size_t depth = 64;           ///< lists and objects inside each other
  std::size_t keys = 10'000;        ///< of one object
  std::size_t text_bytes = 1'000'000;
  std::size_t number_digits = 1'000;  ///< the longest exact double has 1,075
};

/// Parses JSON. Throws Error("place:line") if it is malformed, cut, not UTF-8, beyond a limit, has
/// a key twice in one object, or a number that no double can hold.
nlohmann::ordered_json parse_json(std::string_view text,
                                  const std::string& place,
                                  const JsonLimits& limits = {});

/// The same for a line of a file of many; Error("place:column").
nlohmann::ordered_json parse_json_line(std::string_view line,
                                       const std::string& place,
                                       const JsonLimits& limits = {});

}  // namespace vernier::internal
