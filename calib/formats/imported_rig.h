// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/rig.h"

namespace vernier::internal {

/// What another tool's file may leave unsaid.
struct ImportOptions {
  std::optional<CameraModel> model = {};  ///< unless given, the smallest that holds it exactly
  std::optional<Eigen::Vector2i> size_px = {};  ///< of every camera, where the file has no size
  double unit_m = 1;                            ///< the file's unit of length, metres
};

/// A rig out of another tool's files.
struct ImportedRig {
  Rig rig;
  std::vector<std::string> notes;  ///< what was assumed, and what a rig has no place for
};

/// A file of another tool's, to be written: a rig may need several.
struct ExportedFile {
  std::filesystem::path name;  ///< without a folder
  std::string text;
};

/// The camera's name as one of a file. Throws Error where it is none: empty, a dot first, or with a
/// slash, a backslash or a control character in it.
const std::string& file_stem(const Camera& camera);

/// The rotation nearest to a matrix from a file: the matrix itself where it is orthonormal to
/// rounding (1e-14), U Vᵀ of its singular value decomposition where it is to 1e-6. Throws
/// Error(`place`) beyond that, and for a mirror.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M, const std::string& place);

}  // namespace vernier::internal
