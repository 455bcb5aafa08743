// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera.h"

namespace vernier::internal {

/// Camera parameters as in OpenCV and most other tools:
///
///     fx = f ax, fy = f, cx = ox, cy = oy;  K = [fx 0 cx; 0 fy cy; 0 0 1]
///
/// and the coefficients in OpenCV's order, k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tx ty]]]] (0, 4,
/// 5, 8, 12 or 14 of them), or k1 k2 k3 k4 of cv::fisheye. Pixel (0, 0) is the centre of the first
/// pixel.
struct OpenCvIntrinsics {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  bool fisheye = false;
  std::vector<double> coefficients;
};

Eigen::Matrix3d camera_matrix(const OpenCvIntrinsics& intrinsics);

/// fx, fy, cx, cy of K. Throws Error(`place`) for skew (K01), which the models do not support, and
/// if K is not a camera matrix.
OpenCvIntrinsics intrinsics_of_camera_matrix(const Eigen::Matrix3d& K, const std::string& place);

/// The camera in OpenCV's parameters, with as many coefficients as its model has, radial1 with
/// four.
OpenCvIntrinsics opencv_intrinsics(const Camera& camera);

/// The first `count` coefficients, padded with zeros. Throws Error naming the first non-zero
/// coefficient beyond them, which `tool` cannot represent. For fisheye cameras `count` is 4.
std::vector<double> held_coefficients(const Camera& camera,
                                      std::size_t count,
                                      const std::string& tool);

/// The camera of the intrinsics, whose parameters are checked to be finite, f and ax to be above
/// zero. Its model is `wanted`, or else the smallest that represents the coefficients exactly:
/// pinhole, radial1, opencv4, opencv5, opencv8; for a fisheye, fisheye4. Throws Error(`place`),
/// naming the first non-zero coefficient, if the model cannot represent them.
Camera camera_from_opencv(const OpenCvIntrinsics& intrinsics,
                          const Eigen::Vector2i& size_px,
                          const std::string& place,
                          const std::optional<CameraModel>& wanted = {});

}  // namespace vernier::internal
