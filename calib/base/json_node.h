// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vernier::internal {

/// A JSON value with its location, so that every error gives file and key.
class JsonNode {
 public:
  JsonNode(const nlohmann::ordered_json& json, std::string place)
      : json_(json), place_(std::move(place)) {}

  bool has(const std::string& key) const { return json_.is_object() && json_.contains(key); }
  /// Throws Error if the key is missing.
  JsonNode at(const std::string& key) const;
  JsonNode at(std::size_t index) const;
  std::size_t size() const { return json_.size(); }

  double number() const;  ///< finite
  int integer() const;    ///< within the range of int
  std::string text() const;
  const nlohmann::ordered_json& array() const;
  Eigen::Vector3d vector3() const;
  Eigen::VectorXd vector() const;
  Eigen::MatrixXd matrix() const;  ///< square
  const nlohmann::ordered_json& json() const { return json_; }
  /// Without the colon that sets a line of a file apart from its keys.
  std::string place() const {
    return place_.ends_with(':') ? place_.substr(0, place_.size() - 1) : place_;
  }

 private:
  const nlohmann::ordered_json& json_;
  std::string place_;
};

/// Throws Error for a key that is nearly one of the known (misspelt_key) which is not there; others
/// are passed over.
void check_spelling(const JsonNode& node, const std::vector<std::string_view>& known);

}  // namespace vernier::internal
