// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/rig_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/formats/asl_sensor.h"
#include "calib/formats/colmap_cameras.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/kalibr_camchain.h"
#include "calib/formats/kitti_calib.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/formats/opencv_calibration_file.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"
#include "calib/rig_file.h"
#include "cli/program/chosen_cameras.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<RigFormat, 8> formats{RigFormat::vernier, RigFormat::mrcal, RigFormat::opencv,
                                           RigFormat::kalibr,  RigFormat::ros,   RigFormat::colmap,
                                           RigFormat::asl,     RigFormat::kitti};

/// Whether a line of the text starts with the key.
bool has_key(const std::string& text, const std::string& key) {
  return text.rfind(key + ":", 0) == 0 || text.find("\n" + key + ":") != std::string::npos;
}

/// A JSON file is one of OpenCV's FileStorage, or a rig.json.
RigFormat json_format(const fs::path& file) {
  std::error_code fault;
  const bool opencv = fs::is_regular_file(file, fault) &&
                      read_whole(file).find("\"opencv-matrix\"") != std::string::npos;
  return opencv ? RigFormat::opencv : RigFormat::vernier;
}

/// Distinguishes the YAML formats by their keys.
RigFormat yaml_format(const fs::path& file) {
  const std::string text = read_whole(file);
  if (text.find("opencv-matrix") != std::string::npos) return RigFormat::opencv;
  if (has_key(text, "cam0")) return RigFormat::kalibr;
  if (has_key(text, "T_BS")) return RigFormat::asl;
  if (has_key(text, "projection_matrix") || has_key(text, "P") || has_key(text, "p")) {
    return RigFormat::ros;
  }
  if (text.rfind("%YAML:", 0) == 0) return RigFormat::opencv;
  throw Error(file.string(), "unknown format: its keys match no OpenCV, Kalibr, ROS or ASL file",
              "set --from to opencv, kalibr, ros or asl");
}

RigFormat text_format(const fs::path& file) {
  if (looks_like_kitti_calib(read_whole(file))) return RigFormat::kitti;
  throw Error(file.string(), "unknown format: it holds no projection matrices",
              std::string("add --from, one of ") + rig_format_names);
}

RigFormat folder_format(const fs::path& folder) {
  std::error_code fault;
  if (fs::exists(folder / "cameras.txt", fault)) return RigFormat::colmap;
  if (!asl_sensor_files(folder).empty()) return RigFormat::asl;
  if (fs::exists(folder / "cameras.bin", fault)) {
    throw Error(folder.string(), "holds a COLMAP model in binary form, which is not read",
                "write it as text: colmap model_converter --output_type TXT");
  }
  throw Error(folder.string(), "is a folder without a cameras.txt or cam0/sensor.yaml",
              "give files inside it");
}

const fs::path& only(const std::vector<fs::path>& inputs, std::string_view format) {
  if (inputs.size() > 1) {
    throw Error(inputs[1].string(), fmt::format("a {} rig is a single input", format),
                "give one; only mrcal, OpenCV, ROS and ASL rigs may have several files");
  }
  return inputs[0];
}

/// Keeps everything in a rig.json unless a camera model changes.
ReadRig read_vernier(const fs::path& input, const ImportOptions& options) {
  RigFile file = read_rig(find_rig(input.string()));
  ReadRig read{std::move(file.estimate), std::move(file.warnings)};
  if (!options.model) return read;
  bool changed = false;
  for (Camera& camera : read.estimate.rig.cameras) {
    changed = changed || camera.model.index() != options.model->index();
    const std::string name = camera.name;
    camera = camera_from_opencv(opencv_intrinsics(camera), camera.size_px,
                                fmt::format("camera \"{}\"", name), options.model);
    camera.name = name;
  }
  if (changed) {
    const bool known = read.estimate.covariance || read.estimate.covariance_mvb;
    if (known) read.notes.push_back("the covariance belongs to another model and is dropped");
    read.estimate = {read.estimate.rig, {}, {}, {}, {}, read.estimate.other_keys};
  }
  return read;
}

/// The files that an option names: one, or several separated by commas.
std::vector<fs::path> named_files(const std::string& name) {
  std::error_code fault;
  if (name.find(',') == std::string::npos || fs::exists(name, fault)) return {name};
  std::vector<fs::path> files;
  for (const std::string& file : listed(name)) files.emplace_back(file);
  for (const fs::path& file : files) {
    if (file.empty()) throw Error("--rig " + name, "names an empty file", "give FILE,FILE");
  }
  return files;
}

/// That of a name on the command line: what is no file of another tool is a rig.json or its name.
RigFormat named_format(const std::vector<fs::path>& files) {
  std::error_code fault;
  if (files.size() > 1) return input_format(files);
  const std::string end = files[0].extension().string();
  const bool folder = fs::is_directory(files[0], fault);
  const bool shipped = folder && !shipped_file("rigs/" + files[0].string() + ".rig.json").empty();
  if (folder && !shipped) return folder_format(files[0]);
  if (end == ".json") return json_format(files[0]);
  if (!fs::is_regular_file(files[0], fault)) return RigFormat::vernier;
  const std::string text = read_whole(files[0]);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool json = end != ".cameramodel" && first != std::string::npos && text[first] == '{';
  return json ? RigFormat::vernier : input_format(files[0]);
}

}  // namespace

std::string_view name(RigFormat format) {
  constexpr std::array<std::string_view, 8> names{"vernier", "mrcal",  "opencv", "kalibr",
                                                  "ros",     "colmap", "asl",    "kitti"};
  return names[static_cast<std::size_t>(format)];
}

RigFormat rig_format(const std::string& text,
                     const std::string& option,
                     const std::string& supported) {
  for (const RigFormat format : formats) {
    if (name(format) == text) return format;
  }
  throw Error(option, "unknown format " + in_quotes(text), "supported: " + supported);
}

RigFormat input_format(const fs::path& input) {
  const std::string end = input.extension().string();
  const std::string file = input.filename().string();
  if (file == "cameras.txt" || file == "rig_config.json") return RigFormat::colmap;
  if (file == "cameras.bin" || fs::is_directory(input)) {
    return folder_format(file == "cameras.bin" ? input.parent_path() : input);
  }
  if (end == ".cameramodel") return RigFormat::mrcal;
  if (end == ".yaml" || end == ".yml") return yaml_format(input);
  if (end == ".txt") return text_format(input);
  if (end == ".json") return json_format(input);
  if (end.empty()) return RigFormat::vernier;
  if (std::error_code fault;
      fs::is_regular_file(input, fault) && looks_like_kitti_calib(read_whole(input))) {
    return RigFormat::kitti;
  }
  throw Error(input.string(), "cannot tell the format from the file name",
              std::string("add --from, one of ") + rig_format_names);
}

RigFormat input_format(const std::vector<fs::path>& inputs) {
  const RigFormat format = input_format(inputs[0]);
  for (const fs::path& input : inputs) {
    if (input_format(input) == format) continue;
    throw Error(input.string(),
                fmt::format("is not of the format {} like {}", name(format), inputs[0].string()),
                "give files of one format, or set --from");
  }
  return format;
}

ReadRig read_rig_as(RigFormat format,
                    const std::vector<fs::path>& inputs,
                    const ImportOptions& options) {
  const auto imported = [](ImportedRig rig) {
    ReadRig read;
    read.estimate.rig = std::move(rig.rig);
    read.notes = std::move(rig.notes);
    read.T_body_first = rig.T_body_first;
    return read;
  };
  switch (format) {
    case RigFormat::mrcal:
      return imported(read_mrcal_cameramodels(inputs, options));
    case RigFormat::opencv:
      return imported(read_opencv_calibration(inputs, options));
    case RigFormat::kalibr:
      return imported(read_kalibr_camchain(only(inputs, "Kalibr"), options));
    case RigFormat::ros:
      return imported(read_ros_camera_info(inputs, options));
    case RigFormat::colmap: {
      fs::path input = only(inputs, "COLMAP");
      if (input.filename() == "rig_config.json") input.replace_filename("cameras.txt");
      return imported(read_colmap_cameras(input, options));
    }
    case RigFormat::asl:
      return imported(read_asl_sensors(inputs, options));
    case RigFormat::kitti:
      return imported(read_kitti_calib(only(inputs, "KITTI"), options));
    case RigFormat::vernier:
      break;
  }
  return read_vernier(only(inputs, "Vernier"), options);
}

std::vector<fs::path> files_read(RigFormat format, std::vector<fs::path> inputs) {
  if (format == RigFormat::vernier) inputs[0] = find_rig(inputs[0].string());
  const bool folder = fs::is_directory(inputs[0]);
  if (format == RigFormat::asl && folder) return asl_sensor_files(inputs[0]);
  if (format != RigFormat::colmap) return inputs;
  const fs::path beside = folder ? inputs[0] : inputs[0].parent_path();
  inputs.clear();
  for (const char* name : {"cameras.txt", "images.txt", "rigs.txt", "rig_config.json"}) {
    inputs.push_back(beside / name);
  }
  return inputs;
}

void warn_of_millimetres(RigFormat format,
                         const Rig& rig,
                         const std::string& remedy,
                         Session& session) {
  constexpr double far_m = 10;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const double distance_m = rig.T_camera_first[i].t.norm();
    if (distance_m < far_m) continue;
    session.warn(fmt::format(
        "camera \"{}\" is {:.4g} m from the first; if the file is in millimetres, {}",
        rig.cameras[i].name, distance_m, format == RigFormat::vernier ? "give metres" : remedy));
  }
}

ReadRig read_named_rig(const std::string& named,
                       Session& session,
                       const std::vector<std::string>& images) {
  const std::vector<fs::path> files = named_files(named);
  const RigFormat format = named_format(files);
  ImportOptions options;
  if (!images.empty() && !images.front().empty()) {
    options.size_of_images = [&images](std::size_t camera) {
      const GreyLevels image = read_grey_levels(images[std::min(camera, images.size() - 1)]);
      return Eigen::Vector2i(image.width_px, image.height_px);
    };
    if (format == RigFormat::kitti) options.size_px = options.size_of_images(0);
  }
  ReadRig read = read_rig_as(format, files, options);
  for (const std::string& note : read.notes) {
    if (format == RigFormat::vernier) {
      session.warn(note);
    } else {
      session.info(note);
    }
  }
  warn_of_millimetres(format, read.estimate.rig,
                      "convert it to a rig.json: vernier convert --unit-m 0.001", session);
  return read;
}

ReadRig read_stereo_rig(const std::string& name,
                        Session& session,
                        const std::vector<std::string>& images) {
  ReadRig read = read_named_rig(name, session, images);
  std::string files;
  for (const fs::path& file : named_files(name))
    files += (files.empty() ? "" : " ") + file.string();
  require_pair(read.estimate.rig, name, files);
  return read;
}

std::vector<fs::path> files_of_named_rig(const std::string& named) {
  const std::vector<fs::path> files = named_files(named);
  return files_read(named_format(files), files);
}

}  // namespace vernier::cli
