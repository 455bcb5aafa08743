// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace vernier {

/// What every function throws on a bad argument or a bad file.
///
/// One line for a person: where the fault is (a file, with its line or key where there is one),
/// what is wrong, and what to do about it. An expected failure of a method (too few lines to
/// localise from, say) is no Error but a status in that method's result.
class Error : public std::runtime_error {
 public:
  Error(const std::string& place, const std::string& fault, const std::string& remedy)
      : std::runtime_error(place + ": " + fault + (remedy.empty() ? "" : "; " + remedy)) {}
};

}  // namespace vernier
