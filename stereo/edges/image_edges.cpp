// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/image_edges.h"

#include <cstddef>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

ImageEdges image_edges(const GreyLevels& image,
                       const CannyOptions& canny,
                       const EdgeSegmentOptions& segments) {
  ImageEdges edges{image.width_px, image.height_px, canny_edges(image, canny), {}};
  edges.segments = edge_segments(edges.points, segments);
  return edges;
}

std::vector<int> segment_of_points(const ImageEdges& edges) {
  std::vector<int> segment(edges.points.size(), -1);
  for (std::size_t s = 0; s < edges.segments.size(); ++s) {
    for (const int point : edges.segments[s].points) {
      segment[static_cast<std::size_t>(point)] = static_cast<int>(s);
    }
  }
  return segment;
}

}  // namespace vernier::stereo::internal
