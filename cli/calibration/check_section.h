// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// One part of `vernier check`.
struct CheckSection {
  Json json;                          ///< null where it could not be done
  std::string text;                   ///< its table, or the line that says why there is none
  std::string reason;                 ///< why there is none, else empty
  std::vector<std::string> failures;  ///< gates that do not hold
};

/// A difference and how large it may be. One that is not a number does not hold.
struct ToleranceCheck {
  std::string what, key, where;
  double value = 0, limit = 0;

  bool holds() const { return value <= limit; }
};

/// Adds a table of the gates, its first line `title`, their values under their keys, and a failure
/// for each that does not hold, as "WHAT differ from OTHER by …".
void add_gates(const std::string& title,
               const std::string& other,
               const std::vector<ToleranceCheck>& gates,
               CheckSection& part);

}  // namespace vernier::cli
