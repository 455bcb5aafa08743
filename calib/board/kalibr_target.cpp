// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/kalibr_target.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <type_traits>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/base/yaml_reader.h"
#include "calib/board_target.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr int most_in_row = 1000;  // tags or corners

/// The keys of a flat YAML file. Each key can be taken once.
class FlatYaml {
 public:
  struct Entry {
    std::string value;
    std::size_t line = 0;
  };

  explicit FlatYaml(const std::filesystem::path& file) : file_(file.string()) {
    const YamlValue root = parse_yaml(read_whole(file), file_);
    for (const auto& [key, value] : root.entries) {
      if (value.kind != YamlValue::Kind::scalar) {
        throw Error(place(value.line), "is not of the form key: value",
                    "see Kalibr's target files");
      }
      entries_.insert({key, {value.text, value.line}});
    }
    if (root.kind == YamlValue::Kind::map || root.kind == YamlValue::Kind::null) return;
    throw Error(place(root.line), "is not of the form key: value", "see Kalibr's target files");
  }

  template <class Number>
  Number number(const std::string& key) {
    const Entry entry = take(key);
    const double value = to_real(entry.value).value_or(-1);
    const bool whole = value == std::round(value);
    if (std::is_integral_v<Number> ? whole && value >= 1 && value <= most_in_row
                                   : value > 0 && std::isfinite(value)) {
      return static_cast<Number>(value);
    }
    throw Error(place(entry.line), key + " is " + in_quotes(entry.value),
                std::is_integral_v<Number>
                    ? fmt::format("give a whole number of 1 to {}", most_in_row)
                    : "give a number above 0");
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
    throw Error(place(entry.line), "unknown key '" + shortened(key) + "'",
                "a target has target_type, and tagCols, tagRows, tagSize, tagSpacing or "
                "targetCols, targetRows, rowSpacingMeters, colSpacingMeters");
  }

  std::string place(std::size_t line) const { return file_ + ":" + std::to_string(line); }

 private:
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
    throw Error(yaml.place(offset.line), "codeOffset is " + in_quotes(offset.value),
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
    throw Error(yaml.place(type.line), "target_type is " + in_quotes(type.value),
                "supported: aprilgrid, checkerboard");
  }
  yaml.expect_no_more();
  try {
    check_target(target);
  } catch (const Error& error) {
    throw Error(file.string(), error.place() + ": " + error.fault(), error.remedy());
  }
  return target;
}

}  // namespace vernier::internal
