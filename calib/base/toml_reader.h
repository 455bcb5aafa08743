// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// TOML reading with error messages that give file and line. Not installed.
namespace vernier::internal {

/// Parses TOML. Throws Error(place:line) for bad syntax, a key given twice, and what is beyond the
/// limits of calib/base/toml_grammar.h.
toml::table parse_toml(std::string_view text, const std::string& place);

/// A value as it may be written in a file, on one line; "a table" of a table.
std::string shown_value(const toml::node& node);

/// Typed access to parsed TOML. Every error gives the file and the line.
class TomlReader {
 public:
  /// If `line` is given, every error reports that line: for values defined in another place than
  /// where they are used.
  explicit TomlReader(std::string place, toml::source_index line = 0)
      : place_(std::move(place)), line_(line) {}

  using Keys = std::vector<std::string_view>;

  [[noreturn]] void fail(toml::source_index line,
                         const std::string& fault,
                         const std::string& remedy) const;
  [[noreturn]] void fail(const toml::node& node,
                         const std::string& fault,
                         const std::string& remedy) const;

  /// Rejects unknown keys and suggests the nearest known one.
  void check_keys(const toml::table& table, const Keys& known, const std::string& owner) const;
  const toml::node& required(const toml::table& table,
                             const char* key,
                             const std::string& owner) const;
  std::string text(const toml::node& node, const std::string& what) const;
  /// The same, not empty: the name of a file, or of one that is shipped.
  std::string file_name(const toml::node& node, const std::string& what) const;
  double number(const toml::node& node, const std::string& what) const;
  std::int64_t integer(const toml::node& node, const std::string& what) const;
  const toml::array& list(const toml::node& node, const std::string& what) const;
  const toml::table& table(const toml::node& node, const std::string& what) const;
  /// The tables of [[key]]; empty if the key is absent.
  std::vector<const toml::table*> tables(const toml::table& root, const char* key) const;

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const toml::node& node, const std::string& what) const {
    const toml::array& values = list(node, what);
    if (values.size() != N) {
      fail(node, what + " has " + std::to_string(values.size()) + " numbers",
           "it takes " + std::to_string(N));
    }
    Eigen::Matrix<double, N, 1> result;
    for (int i = 0; i < N; ++i) result[i] = number(*values.get(i), what);
    return result;
  }

  const std::string& place() const { return place_; }

 private:
  std::string place_;
  toml::source_index line_;
};

}  // namespace vernier::internal
