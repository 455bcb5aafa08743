// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "localise/place.h"
#include "stereo/segment.h"

/// Pairwise geometric histograms (PGH). There is one for each line, then called the reference.
/// Every other line is entered at its angle θ to the reference and, evenly, over the range of its
/// points' distances d from the (infinite) reference line. The entry has the mass of the other
/// line's length, so that a line in pieces counts as much as a whole one, and is blurred in both
/// axes by the measurement error:
///
///     H(θ, d) = Σ_lines w N(θ; θ_line, σ_θ²) ∫₀¹ N(d; d(t), σ_d²) dt, d(t) along the other line,
///
/// integrated analytically over each bin. Thacker, Riocreux and Yates, "Assessing the completeness
/// properties of pairwise geometric histograms", Image and Vision Computing 13, 1995; Ashbrook,
/// Thacker, Rockett and Brown, "Robust recognition of scaled shapes using pairwise geometric
/// histograms", BMVC 1995; Aherne, Thacker and Rockett, "Optimal pairwise geometric histograms",
/// BMVC 1997. Space, height bands and all default numbers are ours.
namespace vernier::localise {

using HistogramRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What of a pair of lines is kept. All types ignore shifts and turns of the whole set (in space:
/// turns about the vertical axis).
enum class PghType {
  mirror,    ///< θ in [0, π/2], d >= 0: also ignores reflections and the lines' directions
  rotation,  ///< θ in [0, π) with its sense, d >= 0: ignores directions; a half-turn of the
             ///< reference onto itself swaps its sides, so that d has no sign
  directed,  ///< θ in [0, 2π), d with the sign of its side: ignores neither
};

/// Where the blur of an entry comes from.
enum class PghBlur {
  fixed,      ///< angle_sigma_rad and distance_sigma, the same for all
  per_entry,  ///< the end points' errors of both lines
};

/// By their names above. Throw Error for another.
PghType pgh_type(std::string_view name_of);
PghBlur pgh_blur(std::string_view name_of);
std::string name(PghType type);
std::string name(PghBlur blur);

/// Resolution and blur.
struct PghOptions {
  PghType type = PghType::mirror;
  int angle_bins = 6;       ///< per right angle: rotation has twice, directed four times as many
  int distance_bins = 24;   ///< over [0, max_distance]: directed has as many again below zero
  double max_distance = 6;  ///< metres in space, pixels in the image; larger distances are dropped
  int height_bands = 5;     ///< of the other line's midpoint, spatial histograms only
  double band_height_m = 0.5;
  PghBlur blur = PghBlur::fixed;
  double angle_sigma_rad = 0.26;  ///< fixed blur of each entry in angle
  double distance_sigma = 0.25;   ///< fixed blur in distance, in the unit of max_distance
  double endpoint_sigma_px = 1;   ///< of image lines' ends in either coordinate, for `per_entry`
  double max_weight_m = 2;        ///< maximum weight of a line in space
  int max_lines = 100;            ///< the longest in the image are used
};

/// Default options for image lines: pixels, no bands.
PghOptions image_pgh_options();

/// The axes of histograms. Bins divide the angles from 0 to max_angle_rad and the distances from
/// min_distance to max_distance evenly.
struct PghAxes {
  int bands = 1, angle_bins = 0, distance_bins = 0;
  double max_angle_rad = 0, min_distance = 0, max_distance = 0;

  int bins() const { return bands * angle_bins * distance_bins; }
  /// Column of a bin.
  int column(int band, int angle, int distance) const {
    return (band * angle_bins + angle) * distance_bins + distance;
  }
};

/// Histograms of a set of lines, one per line: a row is the histogram's square root scaled to unit
/// length, so that the dot product of two rows is their Bhattacharyya coefficient (Thacker, Aherne
/// and Rockett, Kybernetika 34, 1998; localise/bhattacharyya.h).
struct Pgh {
  HistogramRows rows;       ///< lines x bins
  Eigen::VectorXf weights;  ///< per row: the line's length; in space at most max_weight_m
  std::vector<int> lines;   ///< per row: index of its line
  PghAxes axes;
};

/// The histograms themselves: the rows squared, each of sum 1.
HistogramRows plain_histograms(const Pgh& pgh);

// Below, a line with no other within reach gets no row. A line without a direction (its ends less
// than 1e-9 apart, or not finite) is ignored. All throw Error for options out of range.

/// Histograms of lines in the image plane. A line points from its first to its second end; for
/// `directed`, order the ends by what both views share, as the polarity of the edge (dark on the
/// left). Angles count from x to y, distances are positive on that side. In `per_entry` both ends
/// of each line err by endpoint_sigma_px.
Pgh image_histograms(std::span<const stereo::ImageSegment> lines, const PghOptions& options);

/// Histograms of lines on the floor as seen from above (robot frame, metres): what is not upright
/// is projected along the vertical axis. Uprights are points: they have no row, and enter those of
/// others in a second band, by distance alone (evenly over all angles). A line points so that the
/// robot is on its left: an edge is seen from the same side of a wall again. Angles count
/// counter-clockwise, distances are positive to the left. In `per_entry` an end errs by the line's
/// sigma_m, independently of the other end; a point as a whole.
Pgh ground_histograms(std::span<const PlaceLine> lines, const PghOptions& options = {});

/// Histograms of lines in space: angle and distance in three dimensions, in bands of the other
/// line's height (robot frame, metres). The vertical axis z gives the signs, as seen from above:
/// with u the direction of the reference, v that of the other line (for `rotation` the one with
/// u·v >= 0), and x - p from the reference to a point, angles count as positive where z·(u × v) > 0
/// and distances where (z × u)·(x - p) > 0.
/// Where that is within its blur (σ_θ, σ_d) of zero, as for uprights, which have no sides when seen
/// from above, it is in doubt and the mass is shared among both signs: Φ(z·(u × v) / σ_θ) and
/// Φ((z × u)·(x - p) / σ_d) to the positive. Uprights and lines that rise more than they run point
/// upward; others so that the robot is on their left as seen from above. In `per_entry` an end errs
/// by the line's sigma_m, independently of the other end; an upright line as a whole.
Pgh spatial_histograms(std::span<const PlaceLine> lines, const PghOptions& options = {});

}  // namespace vernier::localise
