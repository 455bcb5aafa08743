// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

class YamlNode;

/// Information that another tool's file may lack.
struct ImportOptions {
  std::optional<CameraModel> model = {};  ///< default: the smallest that represents it exactly
  std::optional<Eigen::Vector2i> size_px = {};  ///< of every camera, if the file has no size
  double unit_m = 1;                            ///< the file's unit of length, metres
  /// The size of a camera's images, asked where an OpenCV file has none and size_px is not given.
  std::function<Eigen::Vector2i(std::size_t camera)> size_of_images = {};
};

/// A rig imported from another tool's files.
struct ImportedRig {
  Rig rig;
  std::vector<std::string> notes;         ///< assumptions, and information that a rig cannot hold
  std::optional<Pose> T_body_first = {};  ///< of the first camera on what carries it, where stated
};

/// An exported file of another tool's format; a rig may need several.
struct ExportedFile {
  std::filesystem::path name;  ///< without a folder
  std::string text;
};

/// The camera's name, usable as a file name. Throws Error if it is empty, begins with a dot, or
/// contains a slash, a backslash or a control character.
const std::string& file_stem(const Camera& camera);

/// The rotation nearest to a matrix from a file: the matrix itself if it is orthonormal to rounding
/// (1e-14), U Vᵀ of its singular value decomposition if it is to 1e-6. Throws Error(`place`) for
/// larger deviations, and for a reflection.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M, const std::string& place);

/// The position of a camera in metres from a file's unit. Throws Error(`place`) beyond
/// ± `most_value`.
Eigen::Vector3d translation(const Eigen::Vector3d& t, double unit_m, const std::string& place);

/// A pose written as a matrix [R t; 0 0 0 1]. Throws Error naming the node for another matrix, and
/// like the two above.
Pose imported_pose(const YamlNode& matrix, double unit_m);

}  // namespace vernier::internal
