// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"

namespace vernier::internal {

/// mrcal's .cameramodel: one camera a file, a Python dictionary with lensmodel, intrinsics
/// (fx fy cx cy, then the distortion in OpenCV's order), imagersize, and the pose
///
///     x_camera = exp([r]x) x_reference + t
///
/// as (r, t) under `extrinsics` (mrcal 2.2 and before) or `rt_cam_ref` (later versions). The format
/// is that of mrcal's documentation of its class cameramodel. Pixel coordinates are as in Vernier:
/// (0, 0) is the centre of the first pixel.
///
/// Lens models: PINHOLE, OPENCV4, OPENCV5, OPENCV8, and OPENCV12 if its thin-prism terms are zero.
/// All others (splined, CAHVOR, CAHVORE, …) are rejected, and fisheye4 on writing.

/// A rig of one or more files, in the frame of the first; a camera is named after its file.
/// Information that a rig cannot hold (optimization_inputs, valid_intrinsics_region) is noted.
/// Throws Error, with the line, for files that are not cameramodels.
ImportedRig read_mrcal_cameramodels(const std::vector<std::filesystem::path>& files,
                                    const ImportOptions& options = {});
PlacedCamera parse_mrcal_cameramodel(const std::string& text,
                                     const std::string& place,
                                     const ImportOptions& options,
                                     std::vector<std::string>& notes);

/// NAME.cameramodel for every camera, with the first camera's frame as reference. Both keys of the
/// pose are written, numbers in the shortest form that reads back equal.
std::vector<ExportedFile> mrcal_cameramodels(const Rig& rig);

}  // namespace vernier::internal
