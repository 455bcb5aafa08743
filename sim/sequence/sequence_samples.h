// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/joined_lines.h"
#include "stereo/image/depth_image.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// A segment of a view: where its image has it, and in space.
struct SequenceSegment {
  stereo::ImageSegment image_px;
  localise::SightedSegment in_space;
};

/// What a camera of known pose saw. Views are in the order in which they were taken.
struct SequenceView {
  Pose T_world_camera;
  std::vector<SequenceSegment> segments;
};

/// The depth map of a view, by its index; empty: there are none.
using DepthOfView = std::function<stereo::internal::DepthImage(std::size_t view)>;

struct SequenceOptions {
  localise::JoinOptions join;
  double min_length_px = 10;  ///< shorter segments and parts of lines are left out
  int other_views = 3;     ///< that must have seen a stretch of a line for it to be expected in one
  double across_px = 3;    ///< a line is found if a segment lies within this of it …
  double turn_rad = 0.17;  ///< … and is turned by less
  /// With depth maps: a line is in view where a depth beside it is within floor + share of its own.
  double depth_floor_m = 0.03, depth_share = 0.02;
  /// A line is expected in views that have, within this many before and as many after, one that saw
  /// it: poses drift, and edges look otherwise from elsewhere. 0, with depth maps only: in all.
  int bracket_views = 3;
  int neighbour_views = 2;  ///< before and after, that a segment must be confirmed in
  double wrong_sigma = 5;   ///< a depth that is off by more is a mismatch
};

inline constexpr double border_margin_px = 4;  ///< nearer, a line is cut off by the image
inline constexpr double same_end_px = 10;      ///< ends of a line in two views that are one end

/// Where a sample was taken.
struct SampleAt {
  int view = 0;
  double range_m = 0;    ///< of the line's middle from the camera
  double angle_rad = 0;  ///< between the line and the line of sight there, 0 to π/2
  double length_px = 0;  ///< of what is expected of it, or of the segment
};

/// A line expected in a view.
struct ExpectedSample {
  SampleAt at;
  double expected_px = 0, found_px = 0;
  double chance_px = 0;     ///< found beside it, where it is not (mean of displaced lines)
  bool found = false;       ///< by a segment at all
  double chance_found = 0;  ///< share of the displaced lines that were
  int pieces = 0;           ///< segments along it that do not overlap each other
  int line = 0;             ///< which of the joined lines it is
};

/// A segment found on an expected line.
struct FoundSample {
  SampleAt at;
  double length_px = 0;
  double ends_across_px = 0;     ///< distance of one end from the line minus that of the other
  double line_variance_px2 = 0;  ///< of that difference, from the line's own error
  bool joined = false;           ///< it belongs to the line by the join, in space
  bool wrong = false;            ///< its depth is off
};

/// Segments with wrong depths beside an expected line, where it is not, for each displaced line.
struct ChanceSample {
  SampleAt at;
  double wrong = 0;
};

/// An end of a line as two views close to each other have it.
struct EndSample {
  SampleAt at;
  double along_px = 0;
};

/// A segment that other views should show too.
struct ConfirmedSample {
  SampleAt at;
  bool confirmed = false;
  int asked = 0;      ///< how many views should show it
  double chance = 0;  ///< that something else confirms one that is not there
};

/// A segment of a view.
struct SegmentSample {
  SampleAt at;
  bool on_line = false;      ///< joined to one that enough other views saw
  bool depth_agrees = true;  ///< with what the view's own depth map has along it, if there is one
};

struct SequenceSamples {
  std::vector<ExpectedSample> expected;
  std::vector<FoundSample> found;
  std::vector<ChanceSample> chance;
  std::vector<EndSample> ends;
  std::vector<ConfirmedSample> confirmed;
  std::vector<SegmentSample> segments;
  int lines = 0;  ///< joined, seen by enough views
  bool with_depth = false;
};

/// Looks at the same lines again and again: joins the segments of all views in space
/// (localise/joined_lines.h), and asks of every view what it shows of each line that others saw.
/// The line is then fitted without the view's own segments. Equations, and what is taken for
/// expected, found, confirmed and wrong: docs/characterise.md. Throws Error unless the camera is a
/// pinhole, for fewer than three views, and as join_lines() does.
SequenceSamples sequence_samples(const Camera& camera,
                                 std::span<const SequenceView> views,
                                 const DepthOfView& depth,
                                 const SequenceOptions& options = {},
                                 const std::function<void(int done, int total)>& progress = {});

}  // namespace vernier::sim::internal
