// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/json_node.h"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "calib/base/json_whole.h"
#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::internal {

JsonNode JsonNode::at(const std::string& key) const {
  if (!json_.is_object()) throw Error(place(), "is not an object", "");
  if (!json_.contains(key)) throw Error(place(), "has no \"" + key + "\"", "add it");
  return {json_.at(key), place_ + (place_.back() == ':' ? " " : ".") + key};
}

JsonNode JsonNode::at(std::size_t index) const {
  if (index >= array().size()) {
    throw Error(place(), "has only " + std::to_string(json_.size()) + " entries", "");
  }
  return {json_[index], place_ + "[" + std::to_string(index) + "]"};
}

double JsonNode::number() const {
  if (!json_.is_number()) throw Error(place(), "is not a number", "");
  const double value = json_.get<double>();
  if (!std::isfinite(value)) throw Error(place(), "is not finite", "");
  return value;
}

int JsonNode::integer() const {
  if (!json_.is_number_integer()) throw Error(place(), "is not an integer", "");
  const auto whole = json_whole<int>(json_);
  if (!whole) throw Error(place(), json_.dump() + " is too large a whole number", "correct it");
  return *whole;
}

std::string JsonNode::text() const {
  if (!json_.is_string()) throw Error(place(), "is not a string", "");
  return json_.get<std::string>();
}

const nlohmann::ordered_json& JsonNode::array() const {
  if (!json_.is_array()) throw Error(place(), "is not a list", "");
  return json_;
}

Eigen::VectorXd JsonNode::vector() const {
  Eigen::VectorXd v(static_cast<Eigen::Index>(array().size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = at(static_cast<std::size_t>(i)).number();
  return v;
}

Eigen::Vector3d JsonNode::vector3() const {
  const Eigen::VectorXd v = vector();
  if (v.size() != 3) throw Error(place(), "is not a list of 3 numbers", "");
  return v;
}

Eigen::MatrixXd JsonNode::matrix() const {
  const auto n = static_cast<Eigen::Index>(array().size());
  Eigen::MatrixXd m(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd row = at(static_cast<std::size_t>(i)).vector();
    if (row.size() != n) throw Error(place(), "is not a square matrix", "");
    m.row(i) = row.transpose();
  }
  return m;
}

void check_spelling(const JsonNode& node, const std::vector<std::string_view>& known) {
  if (!node.json().is_object()) return;
  for (const auto& [key, value] : node.json().items()) {
    if (const auto meant = misspelt_key(key, known); meant && !node.has(*meant)) {
      throw Error(node.place(), "has an unknown key " + in_quotes(key),
                  "did you mean \"" + *meant + "\"?");
    }
  }
}

}  // namespace vernier::internal
