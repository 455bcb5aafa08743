// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/stereo/stereo_input.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/matcher.h"
#include "stereo/matching/external_matcher.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// The results of a pair, for the output files (docs/segments3d.md).
struct StereoResult {
  std::vector<EdgePoint> edges;
  std::vector<EdgeDisparity> found;
  std::vector<EdgeSegment> segments;
  std::vector<SegmentDisparity> lines;  ///< with the images' own disparities
  std::vector<MeasuredSegment> placed;  ///< one per line; empty without cameras
  MapRange map;                         ///< of a program's map
};

/// edges.csv: every edge point of the rectified left image.
std::string edges_csv(const StereoInput& input, const StereoResult& result);

/// segments.json: segments, separate covariances, and derivatives with respect to the rig.
std::string segments_json(const StereoInput& input, const StereoResult& result);

/// segments.csv: end points and standard deviations; pixels and disparities without cameras.
std::string segments_csv(const StereoResult& result);

/// segments.ply: end points and the edges between them, in the left camera's frame.
std::string segments_ply(const StereoResult& result);

/// The key in segments.json for the status of a segment.
std::string status_key(SegmentStatus status);

}  // namespace vernier::cli
