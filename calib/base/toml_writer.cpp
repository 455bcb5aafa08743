// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/toml_writer.h"

#include <algorithm>
#include <cctype>
#include <locale>
#include <sstream>
#include <string_view>

namespace vernier::internal {
namespace {

std::string scalar_text(const toml::node& value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << toml::toml_formatter(value, toml::format_flags::none);
  return out.str();
}

std::string key_text(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-');
  });
  return bare ? std::string(key) : scalar_text(toml::value<std::string>(std::string(key)));
}

/// A value on one line, tables in braces.
std::string inline_text(const toml::node& node) {
  std::string items;
  const auto add = [&](const std::string& item) { items += (items.empty() ? "" : ", ") + item; };
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& one : *list) add(inline_text(one));
    return "[" + items + "]";
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) add(key_text(key) + " = " + inline_text(value));
    return "{" + items + "}";
  }
  return scalar_text(node);
}

bool is_list_of_tables(const toml::node& node) {
  const toml::array* list = node.as_array();
  return list && !list->empty() && list->is_homogeneous<toml::table>();
}

/// A table whose header, if it has one, is written already.
void write(const toml::table& table, const std::string& name, std::string& text) {
  for (const auto& [key, value] : table) {
    if (value.is_table() || is_list_of_tables(value)) continue;
    text += key_text(key) + " = " + inline_text(value) + "\n";
  }
  for (const auto& [key, value] : table) {
    const std::string full = (name.empty() ? "" : name + ".") + key_text(key);
    if (const toml::table* own = value.as_table()) {
      text += "\n[" + full + "]\n";
      write(*own, full, text);
    } else if (is_list_of_tables(value)) {
      for (const toml::node& one : *value.as_array()) {
        text += "\n[[" + full + "]]\n";
        write(*one.as_table(), full, text);
      }
    }
  }
}

}  // namespace

std::string toml_text(const toml::table& root) {
  std::string text;
  write(root, "", text);
  return text;
}

}  // namespace vernier::internal
