// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"

namespace vernier::localise::internal {

/// A line of the query in the image of its ViewCamera.
struct QueryLine {
  float u = 0, v = 0, w = 0;  ///< its middle
  float dx = 0, dy = 0;       ///< its direction
  float length_px = 0;
  float variance_m2 = 0;  ///< of its distance
  bool steep = false;     ///< it is compared with steep lines, else with flat ones
};

/// Shorter lines in the image are not compared.
inline constexpr float shortest_compared_px = 8;

inline constexpr float steep_below = 0.375f;  ///< |dx| of a steep line of the query

/// Whether a line of the query with this direction is compared with steep lines.
bool is_steep(float dx);

/// The query's lines that are long enough to have a direction.
std::vector<QueryLine> query_lines(const PlaceView& view, const ViewCamera& camera);

/// Predicted lines in the image by columns: an end (u, v, w), the direction, the change of w to the
/// other end; 16 entries beyond `size` match nothing.
struct ImageLines {
  std::vector<float> u, v, w, dw, dx, dy, length_px, per_length, variance_m2, counted;
  std::vector<float> covered_px;  ///< by lines of the query that agree; set by the comparison
  int size = 0;

  void make_room(std::size_t lines);
  void end();
};

/// What both eyes should see of some lines. A line of 14.5 to 30 degrees from the vertical is
/// in both sets, counted in that where the same line of a query would be.
struct PredictedLines {
  ImageLines steep, flat;
};

/// Projects lines to a robot at `pose` in their frame, cut to what both eyes see. Shorter parts
/// than 8 px are dropped. SIMD selected at run time (calib/base/instruction_set.h).
void predict(const SpaceLines& lines,
             const Pose2D& pose,
             const ViewCamera& camera,
             PredictedLines& predicted);

/// When a line of the query agrees with a predicted one: standard deviations of its offset across
/// (flat-topped: the fourth power), its angle and its disparity.
struct LineTolerance {
  float offset_px = 7;            ///< of detection and lateral shifts (ψ_l)
  float offset_m = 0.03f;         ///< of the map's lines, seen at their distance
  float angle_rad = 0.05f;        ///< of directions
  float angle_px = 2;             ///< over the shorter length: the angle's error by its end points
  float disparity_px = 0.6f;      ///< of stereo
  float disparity_share = 0.02f;  ///< of a disparity: calibration, the pose
  /// Largest energy of a disparity: a wrong one (ψ_s) leaves what one eye sees.
  float most_disparity_energy = 8;
};

/// The predicted line that agrees best with a query line.
struct LineMatch {
  float energy = 0;  ///< sum of squared deviations over their variances
  int line = -1;     ///< -1: none within reach
};

/// Compares a query line with all predicted lines of its class, and adds to covered_px what it
/// covers of those that agree.
LineMatch best_match(const QueryLine& query,
                     ImageLines& lines,
                     const ViewCamera& camera,
                     const LineTolerance& tolerance);

/// The deviations of a match over their standard deviations, and these.
struct LineDeviation {
  float offset = 0, disparity = 0;  ///< signed
  float offset_sigma_px = 1, disparity_sigma_px = 1;
};
LineDeviation deviation(const QueryLine& query,
                        const ImageLines& lines,
                        int line,
                        const ViewCamera& camera,
                        const LineTolerance& tolerance);

}  // namespace vernier::localise::internal
