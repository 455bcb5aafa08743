// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cli/program/session.h"
#include "localise/localiser.h"
#include "localise/place.h"

namespace vernier::cli {

/// What came of a query.
struct LocalisedQuery {
  std::string name;
  LocalisationAnswer answer;
  std::optional<Pose2D> truth;
  int lines = 0, looks = 1;
  double cpu_ms = std::numeric_limits<double>::quiet_NaN();

  /// Whether the answer holds a pose: an answer, or an unsure localiser's best guess.
  bool has_pose() const;
  /// Distance of answer and truth; NaN without one of them.
  double error_m() const;
  /// Heading of the answer minus that of the truth; NaN without one of them.
  double heading_error_deg() const;
};

Json queries_json(const std::vector<LocalisedQuery>& queries);
std::string queries_table(const std::vector<LocalisedQuery>& queries);
/// A line a query below a header (docs/file-formats.md).
std::string queries_csv(const std::vector<LocalisedQuery>& queries);

/// Records why the answers are not to be trusted, if there is a reason.
void check_answers(const std::vector<LocalisedQuery>& queries, double off_map, Session& session);

}  // namespace vernier::cli
