// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "localise/join/line_fit.h"
#include "localise/join/line_grid.h"
#include "localise/joined_lines.h"

namespace vernier::localise::internal {

/// A line that is being joined: its sightings, by their place in the list of all.
struct GrowingLine {
  std::vector<int> members;
  FittedLine fit;
  double low_m = 0, high_m = 0;  ///< stations that it reaches
  bool is_in_grid = false;
  Eigen::Vector3d in_grid_a_m, in_grid_b_m;  ///< as the grid has it
};

/// Which sightings are of the same line (join_lines()). Sightings are in order of their views.
class LineAssociation {
 public:
  LineAssociation(std::span<const WorldSighting> sightings, const JoinOptions& options)
      : sightings_(sightings), options_(options), grid_(cell_m(options)) {}

  /// Lines with at least one member, each sighting in one.
  std::vector<GrowingLine> associate();

 private:
  /// A sighting that may belong to a line.
  struct Candidate {
    double cost = 0;
    int sighting = 0, line = 0;
    double mahalanobis2 = 0;
    bool operator<(const Candidate& other) const;
  };

  /// Of the sightings [first, last) of one view; what is of no line begins one.
  void associate_view(int first, int last, bool refits);
  void associate_views(bool refits);
  void associate_anew();
  std::vector<Candidate> candidates(int sighting);
  /// Of a measurement from a line; nothing if it cannot be of it.
  std::optional<LineDistance> gated(const LineMeasurement& m, const GrowingLine& line) const {
    return gated(m, line, options_.gate);
  }
  std::optional<LineDistance> gated(const LineMeasurement& m,
                                    const GrowingLine& line,
                                    double gate) const;
  /// Whether one of the members of the sighting's view overlaps it along the line.
  bool has_rival(int sighting, const GrowingLine& line) const;
  /// Whether members of both from one view overlap, so many that they are two lines.
  bool are_rivals(const GrowingLine& a, const GrowingLine& b) const;
  void refit(int line);
  void keep_in_grid(int line);
  /// Merges lines that agree; how many.
  int merge();
  int best_partner(int line);
  /// Gives the members of lines that others explain as well to these, the smallest lines first.
  void dissolve();
  bool dissolve(int line);
  void drop_empty();

  /// What is within the gates of a segment is within a cell of it, with what the grid lags behind.
  static double cell_m(const JoinOptions& options) {
    return 1.5 * options.max_offset_m + options.max_gap_m;
  }

  std::span<const WorldSighting> sightings_;
  JoinOptions options_;
  LineGrid grid_;
  std::vector<GrowingLine> lines_;
};

}  // namespace vernier::localise::internal
