// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Calibrations in the YAML of OpenCV's samples (cv::FileStorage): K, D of each camera and
/// cv::stereoCalibrate's R, T of the second, x_2 = R x_1 + T, which is our T_right_left.
///
/// Keys; the first of the alternatives is written:
///
///     one camera    camera_matrix | K | M, distortion_coefficients | D
///     a pair        M1 | K1, D1, M2 | K2, D2, R, T
///     three to nine M1 … M9, D1 … D9, R12, T12, R13, T13 … (from the first camera)
///     any           image_width, image_height | image_size, or of camera i image_width_i …;
///                   distortion_model or distortion_model_i: "fisheye", or fisheye_model: 1
///
/// OpenCV has no keys for the image size of a pair, for cv::fisheye and for names: files of other
/// tools lack them (use ImportOptions.size_px), and OpenCV's own programs ignore ours. 4, 5, 8, 12
/// or 14 coefficients can be read (those beyond the eighth must be zero).

/// One rig from the keys of all `files` together (intrinsics.yml and extrinsics.yml, say). Throws
/// Error for a key in two of them, and for a camera matrix with skew.
ImportedRig read_opencv_calibration(const std::vector<std::filesystem::path>& files,
                                    const ImportOptions& options = {});

/// The whole rig in one file, rig.yml. Throws Error for more than nine cameras.
std::vector<ExportedFile> opencv_calibration(const Rig& rig);

/// The same keys in two files, intrinsics.yml and extrinsics.yml, as written by OpenCV's
/// stereo_calib. One file for a single camera.
std::vector<ExportedFile> opencv_intrinsics_and_extrinsics(const Rig& rig);

}  // namespace vernier::internal
