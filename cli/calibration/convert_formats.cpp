// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/convert_formats.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/formats/colmap_cameras.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/kalibr_camchain.h"
#include "calib/formats/mrcal_cameramodel.h"
#include "calib/formats/opencv_calibration_file.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/share_folder.h"
#include "stereo/rectification/rectified_camera_info.h"

namespace vernier::cli {
namespace {

constexpr std::array<RigFormat, 6> formats{RigFormat::vernier, RigFormat::mrcal, RigFormat::opencv,
                                           RigFormat::kalibr,  RigFormat::ros,   RigFormat::colmap};

/// Whether a line of the text starts with the key.
bool has_key(const std::string& text, const std::string& key) {
  return text.rfind(key + ":", 0) == 0 || text.find("\n" + key + ":") != std::string::npos;
}

/// Distinguishes the three YAML formats by their keys.
RigFormat yaml_format(const std::filesystem::path& file) {
  const std::string text = read_whole(file);
  if (text.find("opencv-matrix") != std::string::npos) return RigFormat::opencv;
  if (has_key(text, "cam0")) return RigFormat::kalibr;
  if (has_key(text, "projection_matrix") || has_key(text, "P") || has_key(text, "p")) {
    return RigFormat::ros;
  }
  if (text.rfind("%YAML:", 0) == 0) return RigFormat::opencv;
  throw Error(file.string(), "unknown format: its keys match no OpenCV, Kalibr or ROS file",
              "set --from to opencv, kalibr or ros");
}

const std::filesystem::path& only(const std::vector<std::filesystem::path>& inputs,
                                  std::string_view format) {
  if (inputs.size() > 1) {
    throw Error(inputs[1].string(), fmt::format("a {} rig is a single input", format),
                "give one; only mrcal, OpenCV and ROS rigs may have several files");
  }
  return inputs[0];
}

/// Keeps everything in a rig.json unless a camera model changes.
ReadRig read_vernier(const std::filesystem::path& input, const ImportOptions& options) {
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

std::vector<ExportedFile> foreign_files(RigFormat format, const Rig& rig, bool folder) {
  switch (format) {
    case RigFormat::mrcal:
      return mrcal_cameramodels(rig);
    case RigFormat::opencv:
      return folder ? opencv_intrinsics_and_extrinsics(rig) : opencv_calibration(rig);
    case RigFormat::kalibr:
      return kalibr_camchain(rig);
    case RigFormat::colmap:
      return colmap_cameras(rig);
    case RigFormat::ros: {
      std::vector<ExportedFile> files;
      for (const RosCameraInfo& info : rectified_camera_info(rig)) {
        files.push_back(format_ros_camera_info(info));
      }
      return files;
    }
    case RigFormat::vernier:
      break;
  }
  return {};
}

bool names_a_folder(const std::filesystem::path& output) {
  return !output.has_filename() || std::filesystem::is_directory(output);
}

}  // namespace

std::string_view name(RigFormat format) {
  constexpr std::array<std::string_view, 6> names{"vernier", "mrcal", "opencv",
                                                  "kalibr",  "ros",   "colmap"};
  return names[static_cast<std::size_t>(format)];
}

RigFormat rig_format(const std::string& text, const std::string& option) {
  for (const RigFormat format : formats) {
    if (name(format) == text) return format;
  }
  throw Error(option, "unknown format " + in_quotes(text),
              std::string("supported: ") + rig_format_names);
}

RigFormat input_format(const std::filesystem::path& input) {
  const std::string end = input.extension().string();
  const std::string file = input.filename().string();
  if (file == "cameras.txt" || file == "rig_config.json") return RigFormat::colmap;
  if (std::filesystem::is_directory(input)) {
    if (std::filesystem::exists(input / "cameras.txt")) return RigFormat::colmap;
    throw Error(input.string(), "is a folder without a cameras.txt", "give files inside it");
  }
  if (end == ".cameramodel") return RigFormat::mrcal;
  if (end == ".yaml" || end == ".yml") return yaml_format(input);
  if (end == ".json" || end.empty()) return RigFormat::vernier;
  throw Error(input.string(), "cannot tell the format from the file name",
              std::string("add --from, one of ") + rig_format_names);
}

RigFormat output_format(const std::filesystem::path& output) {
  const std::string end = output.extension().string();
  if (output.filename() == "cameras.txt") return RigFormat::colmap;
  if (end == ".json") return RigFormat::vernier;
  if (end == ".cameramodel") return RigFormat::mrcal;
  throw Error(output.string(), "cannot tell the output format from the file name",
              std::string("add --to, one of ") + rig_format_names);
}

ReadRig read_rig_as(RigFormat format,
                    const std::vector<std::filesystem::path>& inputs,
                    const ImportOptions& options) {
  const auto imported = [](ImportedRig rig) {
    ReadRig read;
    read.estimate.rig = std::move(rig.rig);
    read.notes = std::move(rig.notes);
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
      std::filesystem::path input = only(inputs, "COLMAP");
      if (input.filename() == "rig_config.json") input.replace_filename("cameras.txt");
      return imported(read_colmap_cameras(input, options));
    }
    case RigFormat::vernier:
      break;
  }
  return read_vernier(only(inputs, "Vernier"), options);
}

std::vector<std::pair<std::filesystem::path, std::string>> files_of(
    RigFormat format, const RigEstimate& estimate, const std::filesystem::path& output) {
  const bool folder = names_a_folder(output);
  if (format == RigFormat::vernier) {
    return {{folder ? output / "rig.json" : output, format_rig(estimate)}};
  }
  std::vector<std::pair<std::filesystem::path, std::string>> named;
  const std::vector<ExportedFile> files = foreign_files(format, estimate.rig, folder);
  const bool beside = format == RigFormat::colmap && output.filename() == "cameras.txt";
  if (files.size() > 1 && !folder && !beside) {
    throw Error(output.string(),
                fmt::format("{} stores this rig in {} files", name(format), files.size()),
                "give a folder, with a trailing slash if it does not exist yet");
  }
  named.reserve(files.size());
  for (const ExportedFile& file : files) {
    named.emplace_back(folder   ? output / file.name
                       : beside ? output.parent_path() / file.name
                                : output,
                       file.text);
  }
  return named;
}

std::vector<std::string> lost(RigFormat format, const RigEstimate& estimate) {
  std::vector<std::string> lines;
  if (format == RigFormat::vernier) return lines;
  const auto add = [&](const std::string& what) {
    lines.push_back(fmt::format("{} cannot store {}", name(format), what));
  };
  if (estimate.covariance || estimate.covariance_mvb) {
    add("the covariance; only rig.json stores uncertainty");
  }
  if (estimate.calibration || estimate.evidence) {
    add("the calibration data (calibration, evidence)");
  }
  if (!estimate.other_keys.empty()) add("additional keys of the file");
  const Rig& rig = estimate.rig;
  for (std::size_t i = 0; format == RigFormat::opencv && i < rig.cameras.size(); ++i) {
    if (rig.cameras[i].name == default_camera_name(i)) continue;
    add(fmt::format("names: camera \"{}\" is number {}", rig.cameras[i].name, i + 1));
  }
  if (format == RigFormat::ros && rig.cameras.size() > 2) {
    add("poses of more than two cameras: each file describes one camera only");
  }
  return lines;
}

}  // namespace vernier::cli
