// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/convert_formats.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "calib/camera.h"
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
#include "cli/program/rig_input.h"
#include "stereo/rectification/rectified_camera_info.h"

namespace vernier::cli {
namespace {

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
    case RigFormat::asl:
    case RigFormat::kitti:
      break;
  }
  return {};
}

bool names_a_folder(const std::filesystem::path& output) {
  return !output.has_filename() || std::filesystem::is_directory(output);
}

}  // namespace

RigFormat written_format(const std::string& text) {
  const RigFormat format = rig_format(text, "--to", written_rig_format_names);
  if (format == RigFormat::asl || format == RigFormat::kitti) {
    throw Error("--to", fmt::format("{} is only read", text),
                std::string("supported: ") + written_rig_format_names);
  }
  return format;
}

RigFormat output_format(const std::filesystem::path& output) {
  const std::string end = output.extension().string();
  if (output.filename() == "cameras.txt") return RigFormat::colmap;
  if (end == ".json") return RigFormat::vernier;
  if (end == ".cameramodel") return RigFormat::mrcal;
  throw Error(output.string(), "cannot tell the output format from the file name",
              std::string("add --to, one of ") + written_rig_format_names);
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
