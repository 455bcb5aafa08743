// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/pair_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_matching.h"
#include "stereo/corners/epipolar_band.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/disparity_file.h"
#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/corner_repeatability.h"
#include "stereo/evaluation/edge_loss.h"
#include "stereo/evaluation/end_difference.h"
#include "stereo/evaluation/line_match.h"
#include "stereo/evaluation/segment_shift.h"
#include "stereo/evaluation/warped_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/image/stretched_image.h"
#include "stereo/matcher.h"
#include "stereo/matching/map_window.h"
#include "stereo/matching/matcher_input.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {
namespace {

DisparityMap mirrored_map(DisparityMap map) {
  for (int y = 0; y < map.height_px; ++y) {
    const auto row = map.values.begin() + static_cast<long>(y) * map.width_px;
    std::reverse(row, row + map.width_px);
  }
  return map;
}

/// A pinhole pair in which `range` corresponds to depths from the nearest to infinity.
struct AssumedRig {
  Rig rig;
  double nearest_m = 1;
};

AssumedRig assumed_rig(int width_px, int height_px, const DisparityRange& range) {
  constexpr double baseline_m = 0.1;
  AssumedRig assumed;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = Pinhole{};
    camera.size_px = {width_px, height_px};
    camera.parameters = Eigen::Vector4d(width_px, 1, 0.5 * (width_px - 1) - i * range.min_px,
                                        0.5 * (height_px - 1));
    assumed.rig.cameras.push_back(camera);
  }
  assumed.rig.T_camera_first = {Pose{}, Pose{Eigen::Matrix3d::Identity(), {-baseline_m, 0, 0}}};
  assumed.nearest_m = width_px * baseline_m / std::max(1, range.max_px - range.min_px);
  return assumed;
}

std::vector<Eigen::Vector2d> places(const std::vector<ImageCorner>& corners) {
  std::vector<Eigen::Vector2d> all;
  all.reserve(corners.size());
  for (const ImageCorner& corner : corners) all.push_back(corner.pixel_px);
  return all;
}

void sample_corners(const RectifiedPair& pair,
                    const StereoTruth& truth,
                    const DisparityRange& range,
                    const PairSamplesOptions& options,
                    PairSamples& samples) {
  const AssumedRig assumed = assumed_rig(pair.left.width_px, pair.left.height_px, range);
  const auto [left, right] = corner_images(bytes_of(pair.left), bytes_of(pair.right), assumed.rig,
                                           {.count = options.corners});
  samples.corners =
      corner_repeatabilities(places(left.corners), places(right.corners), truth, options.repeat);
  const int parameters = parameter_count(assumed.rig);
  const EpipolarBand band(assumed.rig, Eigen::MatrixXd::Zero(parameters, parameters),
                          {.nearest_m = assumed.nearest_m});
  samples.corner_matches = corner_errors(match_corners(left, right, band), truth);
}

/// The mirrored pair: the right image becomes the left one.
std::vector<SegmentLoss> losses_to_left(const RectifiedPair& pair,
                                        const StereoTruth& truth,
                                        const PairSamplesOptions& options) {
  const ImageEdges from = image_edges(mirrored(pair.right)), to = image_edges(mirrored(pair.left));
  const DisparityMap other = mirrored_map(truth.disparity);
  const StereoTruth seen = stereo_truth(mirrored_map(truth_of_right(truth)), &other);
  return edge_losses(warped_segments(from, seen, options.warp), to, options.loss);
}

}  // namespace

DisparityMap truth_of_right(const StereoTruth& truth) {
  const DisparityMap& left = truth.disparity;
  DisparityMap right = left;
  std::fill(right.values.begin(), right.values.end(), std::numeric_limits<float>::quiet_NaN());
  const auto shown = [&](int x, int y) {
    return left.known(x, y) && !truth.occluded[static_cast<std::size_t>(y * left.width_px + x)];
  };
  for (int y = 0; y < left.height_px; ++y) {
    for (int x = 0; x + 1 < left.width_px; ++x) {
      if (!shown(x, y) || !shown(x + 1, y)) continue;
      const float d0 = left(x, y), d1 = left(x + 1, y);
      const float r0 = static_cast<float>(x) - d0, r1 = static_cast<float>(x + 1) - d1;
      if (std::abs(d1 - d0) > step_px || !(r1 > r0)) continue;
      const int first = std::max(0, static_cast<int>(std::ceil(r0)));
      const int last = std::min(left.width_px - 1, static_cast<int>(std::floor(r1)));
      for (int r = first; r <= last; ++r) {
        const float d = d0 + (d1 - d0) * (static_cast<float>(r) - r0) / (r1 - r0);
        float& known = right.values[static_cast<std::size_t>(y * left.width_px + r)];
        known = std::fmax(known, d);
      }
    }
  }
  return right;
}

PairSamples pair_samples(const RectifiedPair& pair,
                         const StereoTruth& truth,
                         const DisparityRange& range,
                         const Matcher& matcher,
                         const PairSamplesOptions& options) {
  check_matcher_input(pair, range, "characterise");
  PairSamples samples;
  samples.width_px = pair.left.width_px;
  samples.height_px = pair.left.height_px;
  const ImageEdges left = image_edges(pair.left), right = image_edges(pair.right);
  const std::vector<WarpedSegment> warped = warped_segments(left, truth, options.warp);
  samples.losses = edge_losses(warped, right, options.loss);
  samples.losses_to_left = losses_to_left(pair, truth, options);
  samples.shifts = segment_shifts(warped, right, options.shift);
  samples.ends = segment_ends(left, warped, right, options.ends);
  samples.lines = line_matches(left, matcher.match(pair, left.points, range), truth, options.lines);
  sample_corners(pair, truth, range, options, samples);
  return samples;
}

}  // namespace vernier::stereo::internal
