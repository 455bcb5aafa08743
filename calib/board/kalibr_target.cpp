// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/kalibr_target.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "calib/base/atomic_file.h"
#include "calib/board_target.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The part of a line before a comment: a # at the beginning or after a blank, outside quotes.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return line.substr(0, i);
    }
  }
  return line;
}

std::string_view unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && (text.front() == '\'' || text.front() == '"') &&
                      text.back() == text.front();
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// The keys of a flat YAML file. Each key can be taken once.
class FlatYaml {
 public:
  struct Entry {
    std::string value;
    int line = 0;
  };

  explicit FlatYaml(const std::filesystem::path& file) : file_(file.string()) {
    const std::string text = read_whole(file);
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      add(std::string_view(text).substr(begin, end - begin), ++number);
      begin = end + 1;
    }
  }

  template <class Number>
  Number number(const std::string& key) {
    const Entry entry = take(key);
    Number value{};
    const char* end = entry.value.data() + entry.value.size();
    const auto parsed = std::from_chars(entry.value.data(), end, value);
    if (parsed.ec != std::errc() || parsed.ptr != end || !(value > 0)) {
      throw Error(
          place(entry.line), key + " is \"" + entry.value + "\"",
          std::is_integral_v<Number> ? "give a whole number above 0" : "give a number above 0");
    }
    return value;
  }

  bool has(const std::string& key) const { return entries_.count(key) > 0; }

  Entry take(const std::string& key) {
    const auto at = entries_.find(key);
    if (at == entries_.end()) {
      throw Error(file_, "the key " + key + " is missing", "add it, see Kalibr's target files");
    }
    Entry entry = at->second;
    entries_.erase(at);
    return entry;
  }

  void expect_no_more() const {
    if (entries_.empty()) return;
    const auto& [key, entry] = *entries_.begin();
    throw Error(place(entry.line), "unknown key '" + key + "'",
                "a target has target_type, and tagCols, tagRows, tagSize, tagSpacing or "
                "targetCols, targetRows, rowSpacingMeters, colSpacingMeters");
  }

  std::string place(int line) const { return file_ + ":" + std::to_string(line); }

 private:
  void add(std::string_view raw, int number) {
    const std::string_view line = without_comment(raw);
    if (trimmed(line).empty() || trimmed(line) == "---" || raw.substr(0, 1) == "%") return;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || line.front() == ' ' || line.front() == '\t') {
      throw Error(place(number), "is not of the form key: value", "see Kalibr's target files");
    }
    const std::string key(trimmed(line.substr(0, colon)));
    const std::string value(unquoted(trimmed(line.substr(colon + 1))));
    if (!entries_.insert({key, {value, number}}).second) {
      throw Error(place(number), key + " appears a second time", "remove one of the lines");
    }
  }

  std::string file_;
  std::map<std::string, Entry> entries_;
};

AprilTagGrid april_grid(FlatYaml& yaml) {
  AprilTagGrid grid;
  grid.columns = yaml.number<int>("tagCols");
  grid.rows = yaml.number<int>("tagRows");
  grid.tag_m = yaml.number<double>("tagSize");
  grid.spacing = yaml.number<double>("tagSpacing");
  if (!yaml.has("codeOffset")) return grid;
  const FlatYaml::Entry offset = yaml.take("codeOffset");
  if (offset.value != "0") {
    throw Error(yaml.place(offset.line), "codeOffset is \"" + offset.value + "\"",
                "only codeOffset 0 is supported");
  }
  return grid;
}

Chessboard checkerboard(FlatYaml& yaml) {
  Chessboard board;
  board.columns = yaml.number<int>("targetCols");
  board.rows = yaml.number<int>("targetRows");
  board.square_m = yaml.number<double>("colSpacingMeters");
  board.row_m = yaml.number<double>("rowSpacingMeters");
  return board;
}

}  // namespace

BoardTarget read_kalibr_target(const std::filesystem::path& file) {
  FlatYaml yaml(file);
  const FlatYaml::Entry type = yaml.take("target_type");
  BoardTarget target;
  if (type.value == "aprilgrid") {
    target = april_grid(yaml);
  } else if (type.value == "checkerboard") {
    target = checkerboard(yaml);
  } else if (type.value == "circlegrid") {
    throw Error(yaml.place(type.line), "circlegrid targets are not supported",
                "use a checkerboard, a ChArUco board or an aprilgrid");
  } else {
    throw Error(yaml.place(type.line), "target_type is \"" + type.value + "\"",
                "supported: aprilgrid, checkerboard");
  }
  yaml.expect_no_more();
  check_target(target);
  return target;
}

}  // namespace vernier::internal
