// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/opencv_calibration_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/yaml_node.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

constexpr std::size_t max_cameras = 9;

/// The keys of several files merged into one.
class Keys {
 public:
  explicit Keys(const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) {
      const YamlNode root = YamlNode::parse(read_whole(file), file.string());
      for (const std::string& key : root.keys()) {
        if (!roots_.emplace(key, root).second) {
          throw Error(file.string(),
                      "the key " + in_quotes(key) + " is also in another of the files",
                      "give the files of one rig");
        }
      }
      place_ += (place_.empty() ? "" : ", ") + file.string();
    }
  }

  bool has(const std::string& key) const {
    const auto root = roots_.find(key);
    return root != roots_.end() && root->second.has(key);
  }

  bool has_any(const std::vector<std::string>& keys) const {
    return std::any_of(keys.begin(), keys.end(), [&](const auto& key) { return has(key); });
  }

  YamlNode at_any(const std::vector<std::string>& keys) const {
    for (const std::string& key : keys) {
      if (has(key)) return roots_.find(key)->second.at(key);
    }
    throw Error(place_, "has no \"" + keys[0] + "\"", "add it, or the file that holds it");
  }

 private:
  std::map<std::string, YamlNode> roots_;
  std::string place_;
};

/// Suffix of the keys of camera i (from 1; 0: the only one).
std::string suffix(std::size_t i, const char* separator = "") {
  return i == 0 ? "" : separator + std::to_string(i);
}

std::vector<std::string> matrix_keys(std::size_t i) {
  if (i == 0) return {"camera_matrix", "K", "M", "cameraMatrix"};
  const std::string n = suffix(i);
  return {"M" + n, "K" + n, "camera_matrix_" + n, "camera_matrix" + n, "cameraMatrix" + n};
}

std::vector<std::string> coefficient_keys(std::size_t i) {
  if (i == 0) return {"distortion_coefficients", "D", "distCoeffs"};
  const std::string n = suffix(i);
  return {"D" + n, "distortion_coefficients_" + n, "distortion_coefficients" + n, "distCoeffs" + n};
}

std::optional<Eigen::Vector2i> stated_size(const Keys& keys, std::size_t i) {
  for (const std::string& end : {suffix(i, "_"), std::string()}) {
    if (keys.has("image_width" + end)) {
      return Eigen::Vector2i(keys.at_any({"image_width" + end}).count(),
                             keys.at_any({"image_height" + end}).count());
    }
    if (keys.has("image_size" + end)) return keys.at_any({"image_size" + end}).size_px();
  }
  return std::nullopt;
}

Eigen::Vector2i image_size(const Keys& keys,
                           std::size_t i,
                           const ImportOptions& options,
                           const std::string& place) {
  const std::optional<Eigen::Vector2i> stated = stated_size(keys, i);
  if (!stated && !options.size_px) {
    if (options.size_of_images) return options.size_of_images(i == 0 ? 0 : i - 1);
    throw Error(place, "the file does not give the image size",
                "add image_width and image_height to it, or give convert's option --size");
  }
  if (stated && options.size_px && *stated != *options.size_px) {
    throw Error(place,
                fmt::format("its images are {}x{} in the file, but {}x{} was given", (*stated)[0],
                            (*stated)[1], (*options.size_px)[0], (*options.size_px)[1]),
                "omit or correct the given size");
  }
  return stated ? *stated : *options.size_px;
}

/// Whether the model is cv::fisheye's; std::nullopt if the file does not say.
std::optional<bool> stated_fisheye(const Keys& keys, std::size_t i) {
  for (const std::string& end : {suffix(i, "_"), std::string()}) {
    if (keys.has("fisheye_model" + end)) {
      return keys.at_any({"fisheye_model" + end}).number() != 0;
    }
    if (!keys.has("distortion_model" + end)) continue;
    const YamlNode node = keys.at_any({"distortion_model" + end});
    const std::string name = node.text();
    if (name == "fisheye" || name == "equidistant") return true;
    if (name == "plumb_bob" || name == "rational_polynomial" || name == "opencv") return false;
    throw Error(node.place(), "unsupported distortion model " + in_quotes(name),
                "supported: fisheye, opencv, plumb_bob, rational_polynomial");
  }
  return std::nullopt;
}

Camera read_camera(const Keys& keys,
                   std::size_t i,
                   const ImportOptions& options,
                   std::vector<std::string>& notes) {
  const YamlNode matrix = keys.at_any(matrix_keys(i));
  const Eigen::Matrix3d K = matrix.matrix(3, 3);
  const YamlNode distortion = keys.at_any(coefficient_keys(i));
  OpenCvIntrinsics in = intrinsics_of_camera_matrix(K, matrix.place());
  in.coefficients = distortion.vector();
  const std::size_t n = in.coefficients.size();
  const std::optional<bool> fisheye = stated_fisheye(keys, i);
  const bool wanted = options.model && std::holds_alternative<Fisheye4>(*options.model);
  in.fisheye = fisheye.value_or(wanted && n == 4);
  if (in.fisheye ? n != 4 : n != 0 && n != 4 && n != 5 && n != 8 && n != 12 && n != 14) {
    throw Error(distortion.place(), fmt::format("holds {} coefficients", n),
                in.fisheye ? "cv::fisheye has 4" : "OpenCV has 4, 5, 8, 12 or 14");
  }
  if (!fisheye && !in.fisheye && n == 4) {
    notes.push_back(
        distortion.place() +
        " are read as k1 k2 p1 p2; if they are from cv::fisheye, choose the model fisheye4");
  }
  return camera_from_opencv(in, image_size(keys, i, options, matrix.place()), matrix.place(),
                            options.model);
}

Pose read_pose(const Keys& keys, std::size_t i, std::size_t count, double unit_m) {
  const std::string n = std::to_string(i);
  const bool pair = count == 2;
  const YamlNode R =
      keys.at_any(pair ? std::vector<std::string>{"R", "R12"} : std::vector<std::string>{"R1" + n});
  const YamlNode T =
      keys.at_any(pair ? std::vector<std::string>{"T", "T12"} : std::vector<std::string>{"T1" + n});
  const std::vector<double> t = T.vector();
  if (t.size() != 3) throw Error(T.place(), "is not 3 numbers", "correct it");
  return {nearest_rotation(R.matrix(3, 3), R.place()),
          translation({t[0], t[1], t[2]}, unit_m, T.place())};
}

std::string matrix_text(const std::string& key, const Eigen::MatrixXd& m) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     key, m.rows(), m.cols(), yaml_list(m));
}

std::string camera_text(const Camera& camera, std::size_t i) {
  OpenCvIntrinsics in = opencv_intrinsics(camera);
  in.coefficients.resize(std::max<std::size_t>(4, in.coefficients.size()), 0.0);
  const std::string end = suffix(i, "_");
  return fmt::format("image_width{0}: {1}\nimage_height{0}: {2}\ndistortion_model{0}: {3}\n", end,
                     camera.size_px[0], camera.size_px[1], in.fisheye ? "fisheye" : "opencv") +
         matrix_text(matrix_keys(i)[0], camera_matrix(in)) +
         matrix_text(
             coefficient_keys(i)[0],
             Eigen::Map<const Eigen::RowVectorXd>(
                 in.coefficients.data(), static_cast<Eigen::Index>(in.coefficients.size())));
}

const char* const head = "%YAML:1.0\n---\n";

}  // namespace

ImportedRig read_opencv_calibration(const std::vector<std::filesystem::path>& files,
                                    const ImportOptions& options) {
  const Keys keys(files);
  ImportedRig imported;
  std::vector<PlacedCamera> cameras;
  if (!keys.has_any(matrix_keys(1))) {
    cameras.push_back({read_camera(keys, 0, options, imported.notes), Pose{}});
  } else {
    std::size_t count = 1;
    while (count < max_cameras && keys.has_any(matrix_keys(count + 1))) ++count;
    for (std::size_t i = 1; i <= count; ++i) {
      cameras.push_back({read_camera(keys, i, options, imported.notes),
                         i == 1 ? Pose{} : read_pose(keys, i, count, options.unit_m)});
    }
  }
  imported.rig = rig_of(std::move(cameras));
  return imported;
}

std::vector<ExportedFile> opencv_intrinsics_and_extrinsics(const Rig& rig) {
  const std::size_t count = rig.cameras.size();
  if (count > max_cameras) {
    throw Error("rig", fmt::format("it has {} cameras, more than OpenCV's keys allow", count),
                "nine is the maximum; choose another format");
  }
  if (count == 1) return {{"intrinsics.yml", head + camera_text(rig.cameras[0], 0)}};
  std::string intrinsics = head, extrinsics = head;
  for (std::size_t i = 1; i <= count; ++i) {
    intrinsics += camera_text(rig.cameras[i - 1], i);
    if (i == 1) continue;
    const Pose& T = rig.T_camera_first[i - 1];
    const std::string end = count == 2 ? "" : fmt::format("1{}", i);
    extrinsics += matrix_text("R" + end, T.R) + matrix_text("T" + end, T.t);
  }
  return {{"intrinsics.yml", intrinsics}, {"extrinsics.yml", extrinsics}};
}

std::vector<ExportedFile> opencv_calibration(const Rig& rig) {
  const std::vector<ExportedFile> files = opencv_intrinsics_and_extrinsics(rig);
  ExportedFile whole{"rig.yml", files[0].text};
  if (files.size() > 1) whole.text += files[1].text.substr(std::string(head).size());
  return {whole};
}

}  // namespace vernier::internal
