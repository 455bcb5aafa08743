// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calib/formats/imported_rig.h"

namespace vernier::internal {

/// sensor.yaml of the ASL dataset format, as EuRoC MAV has it (Burri et al., IJRR 2016, and
/// projects.asl.ethz.ch "kmavvisualinertialdatasets"): one file a camera, with
///
///     camera_model: pinhole    intrinsics: [fu, fv, cu, cv]    resolution: [width, height]
///     distortion_model: radial-tangential (k1 k2 p1 p2; also radtan), equidistant (k1 k2 k3 k4,
///         our fisheye4) or none; distortion_coefficients
///     T_BS: 4 x 4, x_body = T_BS x_camera
///
/// so that T_i_first = T_BS_i⁻¹ T_BS_first. Pixel (0, 0) is the centre of the first pixel, as
/// OpenCV, by which these files were made, has it. `rate_hz` and `comment` are ignored.
///
/// The rig of one file a camera, the first one first, or of a folder that asl_sensor_files() knows.
/// A camera is named after its folder where the file is sensor.yaml, else after the file. Throws
/// Error for other models and for sensors that are no cameras.
ImportedRig read_asl_sensors(const std::vector<std::filesystem::path>& files_or_folder,
                             const ImportOptions& options = {});

/// cam0/sensor.yaml, cam1/sensor.yaml … of a folder, or of the mav0 in it, by their numbers. Empty
/// if there is none.
std::vector<std::filesystem::path> asl_sensor_files(const std::filesystem::path& folder);

}  // namespace vernier::internal
