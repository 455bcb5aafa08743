// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/match_images.h"

#include <cstdint>
#include <map>

#include "calib/base/grey_image.h"
#include "calib/board/frame_numbering.h"
#include "calib/board_detection.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/corner_matching.h"
#include "stereo/corners/epipolar_band.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

using FilesByNumber = std::map<std::int64_t, std::filesystem::path>;

FilesByNumber by_number(const std::vector<std::filesystem::path>& files) {
  FilesByNumber numbered;
  for (const auto& file : files) {
    const std::int64_t number = parse_image_name(file).frame;
    const auto [at, is_new] = numbered.emplace(number, file);
    if (!is_new) {
      throw Error(file.string(),
                  "has the same number " + std::to_string(number) + " as " + at->second.string(),
                  "make the last number in each camera's file names unique");
    }
  }
  return numbered;
}

void check_all_paired(const FilesByNumber& own, const FilesByNumber& others, const char* side) {
  for (const auto& [number, file] : own) {
    if (others.count(number)) continue;
    throw Error(file.string(),
                std::string("no ") + side + " image has the number " + std::to_string(number) +
                    " (" + std::to_string(own.size()) + " images here, " +
                    std::to_string(others.size()) + " on the other side)",
                "images of one pair must have the same last number in their names");
  }
}

cv::Mat read_image(const std::filesystem::path& file,
                   const Camera& camera,
                   const std::string& prior_place) {
  cv::Mat grey = read_grey_image(file);
  if (Eigen::Vector2i(grey.cols, grey.rows) != camera.size_px) {
    const auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
    throw Error(file.string(),
                "the size " + size(grey.cols, grey.rows) + " differs from that of camera \"" +
                    camera.name + "\" in " + prior_place + ", " +
                    size(camera.size_px[0], camera.size_px[1]),
                "use images and a prior of the same cameras");
  }
  return grey;
}

}  // namespace

std::vector<ImageFiles> paired_images(const std::string& left, const std::string& right) {
  const auto left_files = matching_files(left), right_files = matching_files(right);
  if (left_files.size() == 1 && right_files.size() == 1) {
    return {{0, left_files.front(), right_files.front()}};
  }
  const FilesByNumber lefts = by_number(left_files), rights = by_number(right_files);
  check_all_paired(lefts, rights, "right");
  check_all_paired(rights, lefts, "left");
  std::vector<ImageFiles> pairs;
  std::vector<std::int64_t> numbers;
  for (const auto& [number, file] : lefts) numbers.push_back(number);
  const FrameNumbering numbering(numbers);  // of time stamps
  for (const auto& [number, file] : lefts) {
    pairs.push_back({numbering.frame(number), file, rights.at(number)});
  }
  return pairs;
}

std::vector<std::filesystem::path> left_images(const std::vector<ImageFiles>& pairs) {
  std::vector<std::filesystem::path> images;
  for (const ImageFiles& pair : pairs) images.push_back(pair.left);
  return images;
}

ImageMatching match_images(const ImageFiles& files,
                           const RigEstimate& prior,
                           const std::string& prior_place,
                           const ImageMatchingOptions& options) {
  const Covariance& covariance = required_covariance(prior, prior_place);
  if (prior.rig.cameras.size() != 2) {
    throw Error(prior_place,
                "the rig has " + std::to_string(prior.rig.cameras.size()) + " cameras instead of 2",
                "use the rig of the two cameras that took the images");
  }
  const EpipolarBand band(prior.rig, covariance.matrix, options.band);
  const cv::Mat left_grey = read_image(files.left, prior.rig.cameras[0], prior_place);
  const cv::Mat right_grey = read_image(files.right, prior.rig.cameras[1], prior_place);
  const auto [left, right] = corner_images(left_grey, right_grey, prior.rig,
                                           {.count = options.corners, .cells = options.cells});
  ImageMatching result;
  result.files = files;
  result.corners_left = static_cast<int>(left.corners.size());
  result.corners_right = static_cast<int>(right.corners.size());
  result.noise_left = left.noise;
  result.noise_right = right.noise;
  result.matches = match_corners(left, right, band, options.matching, &result.candidates);
  return result;
}

void add_matches(PairObservations& pairs, const ImageMatching& matching) {
  for (const CornerMatch& match : matching.matches) {
    Eigen::Vector4d pixels_px;
    pixels_px << match.left_px, match.right_px;
    add_pair(pairs, matching.files.number, pixels_px, match.sigma_px);
  }
}

}  // namespace vernier::stereo::internal
