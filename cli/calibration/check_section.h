// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// One section of the output of `vernier check`.
struct CheckSection {
  Json json;                          ///< null if the check was skipped
  std::string text;                   ///< the table, or a line with the reason why it was skipped
  std::string reason;                 ///< why the check was skipped, otherwise empty
  std::vector<std::string> failures;  ///< exceeded tolerances
};

/// A difference and its tolerance. NaN exceeds any tolerance.
struct ToleranceCheck {
  std::string what, key, where;
  double value = 0, limit = 0;

  bool holds() const { return value <= limit; }
};

/// Adds a table of the differences with the first line `title`, their values under their JSON keys,
/// and a failure "WHAT differ from OTHER by …" for each one above its tolerance.
void add_gates(const std::string& title,
               const std::string& other,
               const std::vector<ToleranceCheck>& gates,
               CheckSection& part);

}  // namespace vernier::cli
