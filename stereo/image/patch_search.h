// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace vernier::stereo::internal {

/// Search window for a patch's centre, both ends included.
struct SearchWindow {
  int min_x = 0, max_x = 0, min_y = 0, max_y = 0;
};

struct FoundPatch {
  cv::Point pixel;          ///< pixel with the best score
  Eigen::Vector2d peak_px;  ///< sub-pixel peak of the parabolas through it and its neighbours
  float score = 0;          ///< ZNCC, in [-1, 1]
  float second = -1;        ///< best score more than two pixels away
};

/// Whether the patch of 2 half + 1 pixels around a pixel lies in the image and has texture: a
/// standard deviation of grey levels of at least 2.
bool has_texture(const cv::Mat& image, cv::Point centre, int half_px);

/// Searches an image (CV_32F) for patches of 2 half + 1 pixels. Precomputes the mean and norm of
/// every patch once for all searches:
///
///     ZNCC(q) = Σ (I − Ī) K(q + i) / (|I − Ī| |K − K̄|)
class PatchSearch {
 public:
  PatchSearch(const cv::Mat& image, int half_px);

  /// Best correlation within the window of the patch around `centre` of another image; the first in
  /// reading order if tied. Only positions whose patch lies in the image are considered; nullopt if
  /// there are none or the patch itself has no texture.
  std::optional<FoundPatch> find(const cv::Mat& other, cv::Point centre, SearchWindow window);

 private:
  void correlate(const cv::Mat& other, cv::Point centre, float mean, const SearchWindow& window);

  cv::Mat image_;
  int half_;
  cv::Mat inverse_length_;     ///< 1 / |K − K̄| of the patch around a pixel; 0 where flat
  cv::Mat mean_;               ///< of the patch around a pixel
  std::vector<float> scores_;  ///< of the window, row-major
};

}  // namespace vernier::stereo::internal
