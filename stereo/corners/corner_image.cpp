// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/corner_image.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/image/image_noise.h"
#include "stereo/image/patch_alignment.h"

namespace vernier::stereo::internal {
namespace {

constexpr double least_ratio = 1.03;
constexpr double most_ratio = 8;

/// √det ∂q / ∂p of q = project_to(R unproject_from(p)) in the middle of the first camera's image:
/// how much larger distant things are in the second one's. None if the second does not see there.
std::optional<double> enlargement(const Camera& from, const Camera& to, const Eigen::Matrix3d& R) {
  const auto ray = try_unproject(from, 0.5 * from.size_px.cast<double>());
  if (!ray) return std::nullopt;
  const Eigen::Vector3d x = R * *ray;
  if (!(x.z() > 0)) return std::nullopt;
  ProjectionJacobian first, second;
  project(from, *ray, first);
  if (!in_image(to, project(to, x, second))) return std::nullopt;
  const double areas =
      (second.point * R.leftCols<2>()).determinant() / first.point.leftCols<2>().determinant();
  if (!(areas > 0 && std::isfinite(areas))) return std::nullopt;
  return std::sqrt(areas);
}

/// How much larger things are in the right image: the geometric mean of what the middles of both
/// images say, since a camera magnifies off its axis and verged cameras look at each other's side.
double magnification(const Rig& rig) {
  const Eigen::Matrix3d& R = rig.T_camera_first[1].R;
  const auto right = enlargement(rig.cameras[0], rig.cameras[1], R);
  const auto left = enlargement(rig.cameras[1], rig.cameras[0], R.transpose());
  const double larger = right && left ? std::sqrt(*right / *left)
                        : right       ? *right
                        : left        ? 1 / *left
                                      : 1;
  return std::clamp(larger, 1 / most_ratio, most_ratio);
}

/// Smooths an image for its reduction. Returns the factor by which its white noise falls.
double smooth(const cv::Mat& grey, double reduction, cv::Mat& smoothed) {
  const double sigma_px = 0.5 * std::sqrt(reduction * reduction - 1);
  const int reach = static_cast<int>(std::ceil(4 * sigma_px));
  const cv::Mat kernel = cv::getGaussianKernel(2 * reach + 1, sigma_px, CV_64F);
  cv::sepFilter2D(grey, smoothed, CV_32F, kernel, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
  return kernel.dot(kernel);
}

}  // namespace

Eigen::Vector2d CornerImage::reduced(const Eigen::Vector2d& pixel_px) const {
  return (pixel_px.array() - 0.5 * (reduction - 1)) / reduction;
}

Eigen::Vector2d CornerImage::raw(const Eigen::Vector2d& reduced_px) const {
  return reduction * reduced_px.array() + 0.5 * (reduction - 1);
}

CornerImage corner_image(const cv::Mat& grey, const HarrisOptions& options, double reduction) {
  CornerImage image;
  image.noise = image_noise(grey);
  if (!(reduction > 1)) {
    image.corners = harris_corners(grey, image.noise, options);
    grey.convertTo(image.grey, CV_32F);
    return image;
  }
  image.reduction = reduction;
  cv::Mat smoothed;
  image.noise *= smooth(grey, reduction, smoothed);
  image.grey.create(std::max(1, static_cast<int>(grey.rows / reduction)),
                    std::max(1, static_cast<int>(grey.cols / reduction)), CV_32F);
  for (int v = 0; v < image.grey.rows; ++v) {
    for (int u = 0; u < image.grey.cols; ++u) {
      const Eigen::Vector2d at = image.raw({u, v});
      image.grey.at<float>(v, u) = static_cast<float>(grey_between(smoothed, at.x(), at.y()));
    }
  }
  image.corners = harris_corners(image.grey, image.noise, options);
  for (ImageCorner& corner : image.corners) {
    corner.pixel_px = image.raw(corner.pixel_px);
    corner.covariance_px2 *= reduction * reduction;
  }
  return image;
}

CornerImages corner_images(const cv::Mat& left,
                           const cv::Mat& right,
                           const Rig& rig,
                           const HarrisOptions& options) {
  const double ratio = magnification(rig);
  const double reduction[2] = {1 / ratio > least_ratio ? 1 / ratio : 1,
                               ratio > least_ratio ? ratio : 1};
  HarrisOptions of_right = options;
  of_right.count += of_right.count / 2;
  return {corner_image(left, options, reduction[0]), corner_image(right, of_right, reduction[1])};
}

}  // namespace vernier::stereo::internal
