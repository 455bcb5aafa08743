// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// The one reader of YAML. Not installed.
namespace vernier::internal {

/// What a YAML text may hold. The largest real file is one of OpenCV's with all its image points: a
/// million numbers take 14 MB.
struct YamlLimits {
  std::size_t bytes = 32'000'000;
  std::size_t values = 2'000'000;
  std::size_t depth = 32;
  std::size_t keys = 10'000;  ///< of one map
  std::size_t text_bytes = 100'000;
};

/// A value of a YAML text. Tags and anchors are ignored.
struct YamlValue {
  enum class Kind { null, scalar, list, map };
  struct Entry;  ///< a pair would need the whole type here
  Kind kind = Kind::null;
  std::size_t line = 0;
  std::string text;              ///< of a scalar, without quotes
  std::vector<YamlValue> items;  ///< of a list
  std::vector<Entry> entries;    ///< of a map, in the file's order

  /// The value of `key`, or null.
  const YamlValue* find(std::string_view key) const;
};

struct YamlValue::Entry {
  std::string key;
  YamlValue value;
};

/// Parses one YAML document, which empty ones may follow: a line --- ends each message of ROS's
/// "topic echo". OpenCV's first line (%YAML:1.0, which is not valid YAML) is accepted.
/// Throws Error("place:line") if the text is malformed, not UTF-8 or beyond a limit, has a key
/// twice in one map, holds a second document, a %TAG directive, or an alias (*name), which could
/// stand for any number of values.
YamlValue parse_yaml(std::string_view text,
                     const std::string& place,
                     const YamlLimits& limits = {});

}  // namespace vernier::internal
