// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/yaml_reader.h"

/// Internal to calib/: YAML as written by other tools. Not installed.
namespace vernier::internal {

/// A node of a YAML file with its location, so that every error gives file, line and key. All
/// members but has() throw Error.
class YamlNode {
 public:
  /// Parses a text (calib/base/yaml_reader.h), which must hold a map.
  static YamlNode parse(const std::string& text, const std::string& file);

  bool has(const std::string& key) const;
  YamlNode at(const std::string& key) const;
  /// The first of these keys that is present; Error about the first one if none is.
  YamlNode at_any(const std::vector<std::string>& keys) const;
  std::vector<std::string> keys() const;

  double number() const;  ///< finite
  int count() const;      ///< a whole number, 1 to 1e6
  std::string text() const;
  std::vector<double> numbers() const;
  std::vector<double> numbers(std::size_t count) const;
  /// rows x cols, as a list of rows, one flat list, or rows, cols and data (OpenCV's and ROS's
  /// layout).
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) const;
  /// A vector as a flat list, or as rows, cols and data with one of them 1.
  std::vector<double> vector() const;

  /// [width, height], whole numbers above 0.
  Eigen::Vector2i size_px() const;

  /// file:line: key
  std::string place() const;

 private:
  YamlNode(std::shared_ptr<const YamlValue> value, std::string file, std::string path)
      : value_(std::move(value)), file_(std::move(file)), path_(std::move(path)) {}
  /// A part of this value, which it keeps.
  YamlNode part(const YamlValue& value, std::string path) const;
  YamlNode item(std::size_t index) const;
  bool is_map() const { return value_->kind == YamlValue::Kind::map; }
  bool is_list() const { return value_->kind == YamlValue::Kind::list; }
  bool is_scalar() const { return value_->kind == YamlValue::Kind::scalar; }

  std::shared_ptr<const YamlValue> value_;
  std::string file_, path_;
};

/// "a, b, c" for a YAML list, in the shortest form that reads back equal.
std::string yaml_list(const std::vector<double>& values);
std::string yaml_list(const Eigen::MatrixXd& row_by_row);

/// A string in YAML quotes.
std::string yaml_text(const std::string& text);

}  // namespace vernier::internal
