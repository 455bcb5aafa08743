// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

namespace vernier {

/// Thrown by every function for an invalid argument or file.
///
/// One line for the user: location (a file, with its line or key if there is one), fault and
/// remedy. what() is "place: fault; remedy". An expected failure of a method (such as too few lines
/// for localisation) is not an Error but a status in the method's result.
class Error : public std::runtime_error {
 public:
  Error(const std::string& place, const std::string& fault, const std::string& remedy)
      : std::runtime_error(place + ": " + fault + (remedy.empty() ? "" : "; " + remedy)),
        parts_(std::make_shared<const Parts>(Parts{place, fault, remedy})) {}

  // No move constructor: a moved-from Error keeps its parts too.
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;

  const std::string& place() const noexcept { return parts_->place; }
  const std::string& fault() const noexcept { return parts_->fault; }
  /// Empty if there is none.
  const std::string& remedy() const noexcept { return parts_->remedy; }

 private:
  struct Parts {
    std::string place, fault, remedy;
  };

  std::shared_ptr<const Parts> parts_;  // shared, so that copying an Error cannot throw
};

}  // namespace vernier
