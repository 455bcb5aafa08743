// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/rig.h"

namespace vernier::internal {

/// COLMAP's cameras.txt (CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]) and the poses from the files next
/// to it.
///
/// COLMAP puts (0, 0) at the corner of the first pixel, so its principal point is ours plus 0.5 in
/// both directions; this is added on writing and subtracted on reading. Its models correspond to:
///
///     PINHOLE, SIMPLE_PINHOLE                              pinhole
///     SIMPLE_RADIAL                                        radial1 with ax = 1
///     RADIAL, OPENCV                                       opencv4 (radial1 with any ax)
///     FULL_OPENCV                                          opencv5, opencv8
///     OPENCV_FISHEYE, RADIAL_FISHEYE, SIMPLE_RADIAL_FISHEYE  fisheye4
///
/// FOV, THIN_PRISM_FISHEYE and others are rejected. ("Camera models", "Output format", "Rig
/// support" of COLMAP's documentation.)

/// Reads a cameras.txt, or the one in a folder. The poses of two or more cameras come from the
/// first of these files in the same folder: rigs.txt (COLMAP 3.12 and later; one rig),
/// rig_config.json (one rig, its cameras identified by their parameters, else by the images under
/// their prefix, else, with a note, by the order of their CAMERA_ID), images.txt (one image per
/// camera). Names are the folders of the images if they are given.
ImportedRig read_colmap_cameras(const std::filesystem::path& file_or_folder,
                                const ImportOptions& options = {});

/// cameras.txt; images.txt with one image per camera that represents its pose, and an empty
/// points3D.txt, which together form a model that every COLMAP opens; and rig_config.json for
/// `colmap rig_configurator` of 3.12 and later.
std::vector<ExportedFile> colmap_cameras(const Rig& rig);

}  // namespace vernier::internal
