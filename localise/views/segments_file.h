// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "localise/joined_lines.h"
#include "localise/views/depth_view.h"
#include "stereo/segment.h"

namespace vernier::localise::internal {

/// A segment of an image with its place in space.
struct ImageSegmentInSpace {
  stereo::ImageSegment image_px;
  SightedSegment in_space;  ///< in the camera's frame
  bool reliable = true;     ///< stereo/segment.h
};

/// The segments of one image, by a name that tells it apart.
struct SegmentsOfImage {
  std::string image;
  std::vector<ImageSegmentInSpace> segments;
};

/// Those of an image with depths that have a place in space.
SegmentsOfImage segments_of(const std::string& image, const DepthSegments& segments);

/// Reads such images, one a line of JSON (docs/file-formats.md, `lines --segments`). Throws Error
/// naming file, line and key for what is malformed, not finite, beyond 1,000 m or of no length, in
/// space or in the image, for a covariance that is not symmetric or not positive semidefinite, and
/// for more than 100,000 images or 100,000 segments in one.
std::vector<SegmentsOfImage> read_segments(const std::filesystem::path& file);

/// One line of such a file, with its end.
std::string segments_line(const SegmentsOfImage& image);

}  // namespace vernier::localise::internal
