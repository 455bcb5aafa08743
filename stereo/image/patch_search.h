// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace vernier::stereo::internal {

/// Pixels in which a patch's centre is sought, both ends included.
struct SearchWindow {
  int min_x = 0, max_x = 0, min_y = 0, max_y = 0;
};

struct FoundPatch {
  cv::Point pixel;          ///< of the best score
  Eigen::Vector2d peak_px;  ///< of the parabolas through it and its neighbours
  float score = 0;          ///< ZNCC, in [-1, 1]
  float second = -1;        ///< best score more than two pixels away
};

/// Whether the patch of 2 half + 1 pixels about a pixel lies in the image and is not flat: grey
/// values that differ by less than a standard deviation of 2 are nothing to correlate.
bool has_texture(const cv::Mat& image, cv::Point centre, int half_px);

/// An image to seek patches of 2 half + 1 pixels in (CV_32F). It prepares the mean and the length
/// of every patch, once for all searches:
///
///     ZNCC(q) = Σ (I − Ī) K(q + i) / (|I − Ī| |K − K̄|)
class PatchSearch {
 public:
  PatchSearch(const cv::Mat& image, int half_px);

  /// Where in the window the patch about `centre` of another image correlates best, of equals the
  /// first in reading order. The part of the window whose patches lie in the image counts; nothing
  /// where there is none or the patch itself has no texture.
  std::optional<FoundPatch> find(const cv::Mat& other, cv::Point centre, SearchWindow window);

 private:
  void correlate(const cv::Mat& other, cv::Point centre, float mean, const SearchWindow& window);

  cv::Mat image_;
  int half_;
  cv::Mat inverse_length_;     ///< 1 / |K − K̄| of the patch about a pixel; 0 where flat
  cv::Mat mean_;               ///< of the patch about a pixel
  std::vector<float> scores_;  ///< of the window, row by row
};

}  // namespace vernier::stereo::internal
