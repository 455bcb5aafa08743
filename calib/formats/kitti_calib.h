// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "calib/formats/imported_rig.h"

namespace vernier::internal {

/// KITTI's calibration files (Geiger, Lenz and Urtasun, CVPR 2012; Geiger et al., IJRR 2013), which
/// describe the rectified images of its cameras by projection matrices:
///
///     pixel ~ P (x_first, 1),   P = K [I | t],   t = K⁻¹ p_4,   x_i = x_first + t
///
/// with x_first in the rectified frame of camera 0. Each camera is a pinhole. Read are
///
///  - calib.txt of the odometry and object data, `P0:` … `P3:`, each with 12 numbers by rows;
///  - calib_cam_to_cam.txt of the raw data: `P_rect_00:` …, with their sizes `S_rect_00:`;
///  - the same matrices without names, also joined without a line end (joined_numbers.h): `P0` …,
///    and `left` and `right` where there are two;
///  - nine numbers: the 3 x 3 camera matrix of a single camera.
///
/// Other entries (Tr, R0_rect, K_00 …, of the lidar or of the images before rectification) are
/// ignored with a note. Only the raw data states a size: else `options.size_px` is needed. A rig
/// names P0's camera first; use a subset for a pair of a file of four.
ImportedRig read_kitti_calib(const std::filesystem::path& file, const ImportOptions& options = {});
ImportedRig parse_kitti_calib(const std::string& text,
                              const std::string& place,
                              const ImportOptions& options = {});

/// Whether a text can be such a file: P0: or P_rect_ begins a line, or the first line that is no
/// comment holds numbers only, nine, twelve or more, or three of a 3 x 3 matrix.
bool looks_like_kitti_calib(const std::string& text);

}  // namespace vernier::internal
