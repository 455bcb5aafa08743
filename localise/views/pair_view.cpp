// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pair_view.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/rig.h"
#include "localise/pair_corners.h"
#include "localise/place.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"
#include "stereo/segment.h"

namespace vernier::localise {

using namespace stereo;
using namespace stereo::internal;

namespace {

std::vector<EdgePoint> edges_at_valid_pixels(const RectifiedImages& images) {
  CannyOptions canny;
  canny.noise = images.pair.left_noise.per_pixel();
  std::vector<EdgePoint> edges = canny_edges(images.pair.left, canny);
  std::erase_if(edges, [&](const EdgePoint& e) { return !images.left_valid(e.x, e.y); });
  return edges;
}

/// A segment of the rectified left image in the image as taken.
std::optional<ImageSegment> raw_segment(const Rig& rig,
                                        const RectifiedGeometry& geometry,
                                        const ImageSegment& rectified) {
  const auto a = raw_pixel(rig, geometry, 0, rectified.a_px);
  const auto b = raw_pixel(rig, geometry, 0, rectified.b_px);
  if (!a || !b) return {};
  return ImageSegment{*a, *b};
}

}  // namespace

PlaceView view_of_pair(const std::shared_ptr<const Rig>& rig,
                       const GreyLevels& left,
                       const GreyLevels& right,
                       const CameraMount& mount,
                       const PairViewOptions& options) {
  if (!rig || rig->cameras.size() != 2) {
    throw Error("rig", "does not have two cameras", "give a stereo rig");
  }
  const RectifiedGeometry geometry = rectified_geometry(*rig);
  const RectifiedImages images = rectified_images(*rig, geometry, left, right, options.threads);
  const int most = options.max_disparity_px > 0 ? options.max_disparity_px
                                                : std::max(1, geometry.size_px[0] / 4);
  const DisparityRange range{options.min_disparity_px, most};

  const std::vector<EdgePoint> edges = edges_at_valid_pixels(images);
  const std::vector<EdgeDisparity> found = edge_matcher().match(images.pair, edges, range);
  const std::vector<SegmentDisparity> lines =
      segment_disparities(edges, edge_segments(edges), found);
  const std::vector<MeasuredSegment> placed = space_segments(lines, geometry);

  std::vector<SpaceSegment> in_space;
  std::vector<StereoSegment> in_images;
  std::vector<ImageSegment> left_only;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::optional<ImageSegment> raw = raw_segment(*rig, geometry, lines[i].left_px);
    if (!raw) continue;
    if (placed[i].status != SegmentStatus::placed) {
      left_only.push_back(*raw);
      continue;
    }
    in_space.push_back(placed[i].segment);
    in_images.push_back({*raw, lines[i].right_px(), 0});  // the right one is not used
  }
  PlaceView view = select_lines(in_space, in_images, mount, options.lines);
  view.rig = rig;
  view.monocular_lines = std::move(left_only);
  if (options.with_corners) {
    view.corners = corners_of_pair(*rig, options.calibration, left, right, options.corners);
  }
  return view;
}

}  // namespace vernier::localise
