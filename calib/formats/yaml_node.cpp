// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/yaml_node.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/base/yaml_reader.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace

YamlNode YamlNode::parse(const std::string& text, const std::string& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '<') {
    throw Error(file, "is XML, which is not read", "write it as YAML (cv::FileStorage: name.yml)");
  }
  auto root = std::make_shared<const YamlValue>(parse_yaml(text, file));
  if (root->kind != YamlValue::Kind::map) throw Error(file, "holds no keys", "name another file");
  return {std::move(root), file, ""};
}

YamlNode YamlNode::part(const YamlValue& value, std::string path) const {
  return {std::shared_ptr<const YamlValue>(value_, &value), file_, std::move(path)};
}

std::string YamlNode::place() const {
  const std::string line = value_->line == 0 ? "" : fmt::format(":{}", value_->line);
  return file_ + line + (path_.empty() ? "" : ": " + path_);
}

bool YamlNode::has(const std::string& key) const {
  const YamlValue* value = value_->find(key);
  return value && value->kind != YamlValue::Kind::null;
}

YamlNode YamlNode::at(const std::string& key) const { return at_any({key}); }

YamlNode YamlNode::at_any(const std::vector<std::string>& keys) const {
  if (!is_map()) throw Error(place(), "holds no keys", "");
  for (const std::string& key : keys) {
    if (has(key)) return part(*value_->find(key), path_.empty() ? key : path_ + "." + key);
  }
  throw Error(path_.empty() ? file_ : place(), "has no \"" + keys[0] + "\"", "add it");
}

YamlNode YamlNode::item(std::size_t index) const {
  return part(value_->items.at(index), fmt::format("{}[{}]", path_, index));
}

std::vector<std::string> YamlNode::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : value_->entries) keys.push_back(key);
  return keys;
}

std::string YamlNode::text() const {
  if (!is_scalar()) throw Error(place(), "is not a string", "");
  const std::string& scalar = value_->text;
  if (std::any_of(scalar.begin(), scalar.end(), is_control)) {
    throw Error(place(), in_quotes(scalar) + " is not a single-line string", "correct it");
  }
  return scalar;
}

double YamlNode::number() const {
  if (!is_scalar()) throw Error(place(), "is not a number", "");
  const std::string& scalar = value_->text;
  if (const auto value = to_finite(scalar)) return *value;
  throw Error(place(), in_quotes(scalar) + " is not a finite number", "correct it");
}

int YamlNode::count() const {
  const double value = number();
  if (!(value >= 1 && value <= 1e6) || value != std::round(value)) {
    throw Error(place(), fmt::format("{} is not a whole number above 0", value), "correct it");
  }
  return static_cast<int>(value);
}

std::vector<double> YamlNode::numbers() const {
  if (!is_list()) throw Error(place(), "is not a list", "");
  std::vector<double> values;
  for (std::size_t i = 0; i < value_->items.size(); ++i) values.push_back(item(i).number());
  return values;
}

std::vector<double> YamlNode::numbers(std::size_t count) const {
  std::vector<double> values = numbers();
  if (values.size() != count) {
    throw Error(place(), fmt::format("holds {} numbers, not {}", values.size(), count),
                "correct it");
  }
  return values;
}

Eigen::MatrixXd YamlNode::matrix(Eigen::Index rows, Eigen::Index cols) const {
  const auto wrong = [&](std::size_t stated_rows, std::size_t stated_cols) {
    throw Error(place(), fmt::format("is {}x{}, not {}x{}", stated_rows, stated_cols, rows, cols),
                "correct it");
  };
  std::vector<double> values;
  if (is_map()) {
    const int r = at("rows").count(), c = at("cols").count();
    if (r != rows || c != cols) wrong(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
    values = at("data").numbers(static_cast<std::size_t>(rows * cols));
  } else if (is_list() && !value_->items.empty() && item(0).is_list()) {
    if (value_->items.size() != static_cast<std::size_t>(rows))
      wrong(value_->items.size(), value_->items[0].items.size());
    for (std::size_t i = 0; i < value_->items.size(); ++i) {
      const std::vector<double> row = item(i).numbers(static_cast<std::size_t>(cols));
      values.insert(values.end(), row.begin(), row.end());
    }
  } else {
    values = numbers(static_cast<std::size_t>(rows * cols));
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(values.data(), rows, cols);
}

std::vector<double> YamlNode::vector() const {
  if (!is_map()) return numbers();
  const double r = at("rows").number(), c = at("cols").number();
  if (r * c == 0) return {};
  if (r != 1 && c != 1) throw Error(place(), "is not a single row or column", "correct it");
  return at("data").numbers(static_cast<std::size_t>(at("rows").count()) *
                            static_cast<std::size_t>(at("cols").count()));
}

Eigen::Vector2i YamlNode::size_px() const {
  const std::vector<double> size = vector();
  const auto whole = [](double s) { return s >= 1 && s <= 1e6 && s == std::round(s); };
  if (size.size() != 2 || !whole(size[0]) || !whole(size[1])) {
    throw Error(place(), "is not [width, height]", "give two whole numbers above 0");
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

std::string yaml_list(const std::vector<double>& values) {
  return fmt::format("{}", fmt::join(values, ", "));
}

std::string yaml_list(const Eigen::MatrixXd& row_by_row) {
  std::vector<double> values;
  for (Eigen::Index r = 0; r < row_by_row.rows(); ++r) {
    for (Eigen::Index c = 0; c < row_by_row.cols(); ++c) values.push_back(row_by_row(r, c));
  }
  return yaml_list(values);
}

std::string yaml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (is_control(c)) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace vernier::internal
