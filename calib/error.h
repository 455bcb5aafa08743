// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

namespace vernier {

/// What every function throws on a bad argument or a bad file.
///
/// One line for a person: where the fault is (a file, with its line or key where there is one),
/// what is wrong, and what to do about it. what() gives the three as "place: fault; remedy". An
/// expected failure of a method (too few lines to localise from, say) is no Error but a status in
/// that method's result.
class Error : public std::runtime_error {
 public:
  Error(const std::string& place, const std::string& fault, const std::string& remedy)
      : std::runtime_error(place + ": " + fault + (remedy.empty() ? "" : "; " + remedy)),
        parts_(std::make_shared<const Parts>(Parts{place, fault, remedy})) {}

  // No move: what is moved from keeps its parts too.
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;

  const std::string& place() const noexcept { return parts_->place; }
  const std::string& fault() const noexcept { return parts_->fault; }
  /// Empty where there is none.
  const std::string& remedy() const noexcept { return parts_->remedy; }

 private:
  struct Parts {
    std::string place, fault, remedy;
  };

  std::shared_ptr<const Parts> parts_;  // shared, so that copying an Error cannot throw
};

}  // namespace vernier
