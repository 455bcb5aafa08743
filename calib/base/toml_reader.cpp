// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>

#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/base/toml_grammar.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

/// The line of that number, from 1, without the blanks around it.
std::string_view trimmed_line(std::string_view text, std::size_t number) {
  for (std::size_t line = 1; line < number && !text.empty(); ++line) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  text = text.substr(0, text.find('\n'));
  const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

/// Whether toml++ could not read a number that is one: its stream swallows std::bad_alloc.
bool lacks_memory(std::string_view description) {
  constexpr std::string_view begin = "Error while parsing floating-point: '";
  if (!description.starts_with(begin)) return false;
  description.remove_prefix(begin.size());
  return to_real(description.substr(0, description.find('\''))).has_value();
}

}  // namespace

// After check_toml only definitions that repeat or contradict others are left to fail, and the
// library's message repeats parts of their keys.
toml::table parse_toml(std::string_view text, const std::string& place) {
  check_toml(text, place);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    if (lacks_memory(error.description())) throw std::bad_alloc();
    const toml::source_index line = error.source().begin.line;
    const std::string named = place + ":" + std::to_string(line);
    if (error.description().find("existing") == std::string_view::npos) {
      throw Error(named, "not TOML: " + std::string(error.description()), "correct the syntax");
    }
    throw Error(named, in_quotes(trimmed_line(text, line)) + " defines what is defined before",
                "define every key and table once");
  }
}

std::string shown_value(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  if (const auto* text = node.as_string()) return text->get();
  const toml::array* values = node.as_array();
  if (!values) return "a table";
  std::string list;
  for (const toml::node& value : *values) {
    list += (list.empty() ? "" : ", ") + shown_value(value);
  }
  return "[" + list + "]";
}

void TomlReader::fail(toml::source_index line,
                      const std::string& fault,
                      const std::string& remedy) const {
  const toml::source_index named = line_ > 0 ? line_ : std::max<toml::source_index>(line, 1);
  // Names and texts of the file are part of them.
  constexpr std::size_t most_bytes = 240;
  throw Error(place_ + ":" + std::to_string(named), printable(fault, most_bytes),
              printable(remedy, most_bytes));
}

void TomlReader::fail(const toml::node& node,
                      const std::string& fault,
                      const std::string& remedy) const {
  fail(node.source().begin.line, fault, remedy);
}

void TomlReader::check_keys(const toml::table& table,
                            const Keys& known,
                            const std::string& owner) const {
  for (const auto& [key, value] : table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    fail(key.source().begin.line,
         "unknown key '" + shortened(key.str()) + "'" + (owner.empty() ? "" : " in " + owner),
         unknown_word_remedy(key.str(), known));
  }
}

const toml::node& TomlReader::required(const toml::table& table,
                                       const char* key,
                                       const std::string& owner) const {
  const toml::node* node = table.get(key);
  if (!node) fail(table, owner + " has no '" + key + "'", "add it");
  return *node;
}

std::string TomlReader::text(const toml::node& node, const std::string& what) const {
  if (!node.is_string()) fail(node, what + " is not a string", "put it in quotes");
  const std::string& text = node.as_string()->get();
  if (text.find('\0') != std::string::npos) {
    fail(node, what + " holds a zero byte", "remove \\u0000");  // a file name would end there
  }
  return text;
}

std::string TomlReader::file_name(const toml::node& node, const std::string& what) const {
  std::string name = text(node, what);
  if (name.empty()) fail(node, what + " is empty", "name a file");
  return name;
}

double TomlReader::number(const toml::node& node, const std::string& what) const {
  double value = 0;
  if (const auto* real = node.as_floating_point()) {
    value = real->get();
  } else if (const auto* whole = node.as_integer()) {
    value = static_cast<double>(whole->get());
  } else {
    fail(node, what + " holds something that is not a number", "write a number");
  }
  if (!std::isfinite(value)) {
    fail(node, what + " holds a number that is not finite", "write a finite number");
  }
  return value;
}

const toml::array& TomlReader::list(const toml::node& node, const std::string& what) const {
  if (!node.is_array()) fail(node, what + " is not a list", "write it as [ … ]");
  return *node.as_array();
}

const toml::table& TomlReader::table(const toml::node& node, const std::string& what) const {
  if (!node.is_table()) fail(node, what + " is not a table", "write it as a table of keys");
  return *node.as_table();
}

std::vector<const toml::table*> TomlReader::tables(const toml::table& root, const char* key) const {
  std::vector<const toml::table*> found;
  const toml::node* node = root.get(key);
  if (!node) return found;
  const std::string heading = std::string("[[") + key + "]]";
  if (!node->is_array()) {
    fail(*node, std::string("'") + key + "' is not a list of tables", "write " + heading);
  }
  for (const auto& entry : *node->as_array()) found.push_back(&table(entry, heading));
  return found;
}

std::int64_t TomlReader::integer(const toml::node& node, const std::string& what) const {
  if (!node.is_integer()) {
    fail(node, what + " is not a whole number",
         node.is_floating_point() ? "write it without a decimal point"
         : node.is_string()       ? "write a number, without quotes"
                                  : "write a number");
  }
  return node.as_integer()->get();
}

}  // namespace vernier::internal
