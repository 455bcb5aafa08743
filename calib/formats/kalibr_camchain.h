// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Kalibr's camchain.yaml: cameras cam0, cam1 … with
///
///     camera_model: pinhole     intrinsics: [fu, fv, pu, pv]     resolution: [width, height]
///     distortion_model: radtan (k1 k2 p1 p2), equidistant (k1 k2 k3 k4, our fisheye4) or none
///     T_cn_cnm1: 4x4, x_n = T x_(n-1), for each camera after the first in the chain
///
/// (Kalibr's wiki, "yaml formats"). The pose of camera n is therefore the product
/// T_n_first = T_n_(n-1) … T_1_0. Without T_cn_cnm1 it follows from T_cam_imu (x_cam = T x_imu) of
/// both cameras: T_cn_cnm1 = T_cn_imu T_cnm1_imu⁻¹. Throws Error where both are given and differ by
/// more than rounding (1e-5, in radians and relative to the lengths). Other camera models (omni,
/// eucm, ds) and fov are refused.

/// A camera is named after its rostopic if the names are distinct (/stereo/left/image_raw gives
/// left), else cam0, cam1 …. Else T_cam_imu, and timeshift_cam_imu, are ignored with a note.
ImportedRig read_kalibr_camchain(const std::filesystem::path& file,
                                 const ImportOptions& options = {});

/// camchain.yaml. Throws Error for a non-zero coefficient beyond p2, which radtan does not have.
std::vector<ExportedFile> kalibr_camchain(const Rig& rig);

}  // namespace vernier::internal
