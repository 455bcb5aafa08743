// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/yaml_node.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/base/text_lines.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// A scalar as quoted in error messages: short, on one line.
std::string quoted(std::string scalar) {
  for (char& c : scalar) c = is_control(c) ? '?' : c;
  return '"' + (scalar.size() > 40 ? scalar.substr(0, 40) + "..." : scalar) + '"';
}

}  // namespace

YamlNode YamlNode::parse(const std::string& text, const std::string& file) {
  std::string body = text;
  if (body.rfind("%YAML:", 0) == 0) body.replace(0, 1, "#");
  try {
    YAML::Node root = YAML::Load(body);
    if (!root.IsMap()) throw Error(file, "holds no keys", "name another file");
    return {root, file, ""};
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : fmt::format(":{}", error.mark.line + 1);
    throw Error(file + line, "is not YAML: " + error.msg, "correct it");
  }
}

std::string YamlNode::place() const {
  const YAML::Mark mark = node_.Mark();
  const std::string line = mark.is_null() ? "" : fmt::format(":{}", mark.line + 1);
  return file_ + line + (path_.empty() ? "" : ": " + path_);
}

bool YamlNode::has(const std::string& key) const {
  return node_.IsMap() && node_[key] && !node_[key].IsNull();
}

YamlNode YamlNode::at(const std::string& key) const { return at_any({key}); }

YamlNode YamlNode::at_any(const std::vector<std::string>& keys) const {
  if (!node_.IsMap()) throw Error(place(), "holds no keys", "");
  for (const std::string& key : keys) {
    if (has(key)) return {node_[key], file_, path_.empty() ? key : path_ + "." + key};
  }
  throw Error(path_.empty() ? file_ : place(), "has no \"" + keys[0] + "\"", "add it");
}

YamlNode YamlNode::item(std::size_t index) const {
  return {node_[index], file_, fmt::format("{}[{}]", path_, index)};
}

std::vector<std::string> YamlNode::keys() const {
  std::vector<std::string> keys;
  if (!node_.IsMap()) return keys;
  for (const auto& entry : node_) {
    if (entry.first.IsScalar()) keys.push_back(entry.first.Scalar());
  }
  return keys;
}

std::string YamlNode::text() const {
  if (!node_.IsScalar()) throw Error(place(), "is not a string", "");
  const std::string& scalar = node_.Scalar();
  if (std::any_of(scalar.begin(), scalar.end(), is_control)) {
    throw Error(place(), quoted(scalar) + " is not a single-line string", "correct it");
  }
  return scalar;
}

double YamlNode::number() const {
  if (!node_.IsScalar()) throw Error(place(), "is not a number", "");
  const std::string& scalar = node_.Scalar();
  if (const auto value = to_real(scalar); value && std::isfinite(*value)) return *value;
  throw Error(place(), quoted(scalar) + " is not a finite number", "correct it");
}

int YamlNode::count() const {
  const double value = number();
  if (!(value >= 1 && value <= 1e6) || value != std::round(value)) {
    throw Error(place(), fmt::format("{} is not a whole number above 0", value), "correct it");
  }
  return static_cast<int>(value);
}

std::vector<double> YamlNode::numbers() const {
  if (!node_.IsSequence()) throw Error(place(), "is not a list", "");
  std::vector<double> values;
  for (std::size_t i = 0; i < node_.size(); ++i) values.push_back(item(i).number());
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
  if (node_.IsMap()) {
    const int r = at("rows").count(), c = at("cols").count();
    if (r != rows || c != cols) wrong(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
    values = at("data").numbers(static_cast<std::size_t>(rows * cols));
  } else if (node_.IsSequence() && node_.size() > 0 && node_[0].IsSequence()) {
    if (node_.size() != static_cast<std::size_t>(rows)) wrong(node_.size(), node_[0].size());
    for (std::size_t i = 0; i < node_.size(); ++i) {
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
  if (!node_.IsMap()) return numbers();
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
