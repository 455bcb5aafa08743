// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/output_files.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/formats/imported_rig.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/calibration/convert_formats.h"
#include "cli/program/chosen_cameras.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

using NamedContents = std::vector<std::pair<std::filesystem::path, std::string>>;

struct ConvertArguments {
  std::vector<std::string> inputs;
  std::string output, from, to, model, cameras, names, size;
  double unit_m = 1;
};

ImportOptions import_options(const ConvertArguments& options) {
  ImportOptions import;
  import.unit_m = options.unit_m;
  if (!options.model.empty()) import.model = camera_model(options.model);
  if (!options.size.empty()) {
    const auto sizes = parse_sizes(options.size, "--size");
    const auto size_of = [sizes](std::size_t camera) {
      const auto& [width, height] = sizes[std::min(camera, sizes.size() - 1)];
      return Eigen::Vector2i(width, height);
    };
    if (sizes.size() == 1) {
      import.size_px = size_of(0);
    } else {
      import.size_of_images = size_of;  // check_sizes counts them
    }
  }
  return import;
}

/// Keeps the cameras of a list such as "P2,P3", in its order, with their part of the covariance.
/// The evidence, which is of all cameras, goes.
void keep_cameras(ReadRig& read, const std::string& list) {
  if (list.empty()) return;
  RigEstimate& estimate = read.estimate;
  const std::vector<int> kept = chosen_cameras(estimate.rig, list);
  const bool had_evidence = estimate.evidence.has_value();
  estimate = part_of(estimate, kept);
  if (had_evidence && !estimate.evidence) {
    read.notes.emplace_back(
        "the views and corners are of all cameras and are dropped; the covariance of the kept "
        "cameras and the figures of the whole calibration stay");
  }
}

/// Throws Error unless sizes of several cameras are those of all.
void check_sizes(const Rig& rig, const std::string& list) {
  if (list.find(',') == std::string::npos) return;
  const auto sizes = parse_sizes(list, "--size");
  const auto count = static_cast<std::int64_t>(rig.cameras.size());
  if (sizes.size() != rig.cameras.size()) {
    throw Error("--size " + list, "the rig has " + counted(count, "camera"),
                "give one size, or one of each camera");
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Camera& camera = rig.cameras[i];
    if (camera.size_px == Eigen::Vector2i(sizes[i].first, sizes[i].second)) continue;
    throw Error("--size " + list,
                fmt::format("camera \"{}\" is of {}x{} px by the file", camera.name,
                            camera.size_px[0], camera.size_px[1]),
                "leave it out");
  }
}

/// Renames the cameras from a list such as "left,right".
void rename(RigEstimate& estimate, const std::string& list) {
  if (list.empty()) return;
  try {
    rename_cameras(estimate, listed(list));
  } catch (const Error& error) {
    throw Error("--names " + list, error.fault(), error.remedy() + ", separated by commas");
  }
}

/// Throws Error for options whose value the input already contains.
void check_options(const ConvertArguments& options, RigFormat from) {
  if (from == RigFormat::kitti && options.size.find(',') != std::string::npos) {
    throw Error("--size " + options.size, "images of a KITTI file have one size",
                "give one, such as --size 1241x376");
  }
  if (!options.size.empty() && from != RigFormat::opencv && from != RigFormat::kitti) {
    throw Error("--size", fmt::format("{} files contain the image size", name(from)),
                "leave it out");
  }
  if (options.unit_m != 1 && from == RigFormat::vernier) {
    throw Error("--unit-m", "rig.json files are in metres", "leave it out");
  }
}

/// COLMAP files have fixed names: do not overwrite those of a reconstruction.
void check_no_reconstruction(const NamedContents& files) {
  const std::filesystem::path folder = files[0].first.parent_path();
  bool reconstruction = false;
  for (const char* name : {"cameras.bin", "images.bin", "rigs.txt", "rigs.bin"}) {
    reconstruction = reconstruction || std::filesystem::exists(folder / name);
  }
  for (const auto& [file, content] : files) {
    if (file.filename() != "points3D.txt" || !std::filesystem::is_regular_file(file)) continue;
    reconstruction = reconstruction || read_whole(file) != content;
  }
  if (reconstruction) {
    throw Error(folder.string(), "contains a COLMAP reconstruction that would be overwritten",
                "give another folder");
  }
}

/// Writes all files or none; creates the output folder if the output ends in a slash.
void write_all(const NamedContents& files, const std::filesystem::path& output) {
  const std::filesystem::path folder = output.parent_path(), above = folder.parent_path();
  OutputFiles outputs;
  if (!output.has_filename() && (above.empty() || std::filesystem::is_directory(above))) {
    outputs.add_folder(folder);
  }
  for (const auto& [file, content] : files) outputs.add(file, content);
  outputs.commit();
}

/// Warns of cameras whose size is probably another's. `told` is the size that was given, or empty.
void warn_of_far_centres(const Rig& rig, const std::string& told, Session& session) {
  constexpr double far_off = 0.2;  // of a side, from the middle; lenses differ by a few percent
  for (const Camera& camera : rig.cameras) {
    const Eigen::Array2d size = camera.size_px.cast<double>();
    const Eigen::Array2d off = Eigen::Array2d(camera.ox_px(), camera.oy_px()) - 0.5 * (size - 1);
    if ((off.abs() <= far_off * size).all()) continue;
    session.warn(fmt::format(
        "camera \"{}\": its principal point ({:.0f}, {:.0f}) is far from the middle of {}x{} px; "
        "check the size of its images{}",
        camera.name, camera.ox_px(), camera.oy_px(), camera.size_px[0], camera.size_px[1],
        told.empty() ? ", which the file gives"
                     : " (--size 640x480,1280x960 gives one of each camera)"));
  }
}

void report_notes(const ReadRig& read,
                  RigFormat from,
                  const std::vector<std::string>& losses,
                  const std::string& told_size,
                  Session& session) {
  for (const std::string& note : read.notes) session.info(note);
  warn_of_millimetres(from, read.estimate.rig, "add --unit-m 0.001", session);
  for (const std::string& line : losses) session.info(line);
  warn_of_far_centres(read.estimate.rig, told_size, session);
}

void run(const ConvertArguments& options, Session& session) {
  const std::vector<std::filesystem::path> inputs(options.inputs.begin(), options.inputs.end());
  const RigFormat from =
      options.from.empty() ? input_format(inputs) : rig_format(options.from, "--from");
  const RigFormat to =
      options.to.empty() ? output_format(options.output) : written_format(options.to);
  check_options(options, from);
  ReadRig read = read_rig_as(from, inputs, import_options(options));
  check_sizes(read.estimate.rig, options.size);
  keep_cameras(read, options.cameras);
  rename(read.estimate, options.names);
  const Rig& rig = read.estimate.rig;
  const auto files = files_of(to, read.estimate, options.output);
  for (const auto& [file, content] : files)
    check_output_is_not_input(files_read(from, inputs), file);
  if (to == RigFormat::colmap) check_no_reconstruction(files);
  write_all(files, options.output);
  const std::vector<std::string> losses = lost(to, read.estimate);
  report_notes(read, from, losses, options.size, session);

  Json cameras = Json::array(), written = Json::array();
  std::string text;
  for (const Camera& camera : rig.cameras) {
    cameras.push_back({{"name", camera.name},
                       {"model", model_name(camera.model)},
                       {"size_px", {camera.size_px[0], camera.size_px[1]}}});
    text += fmt::format("  {}: {}, {} x {}\n", camera.name, model_name(camera.model),
                        camera.size_px[0], camera.size_px[1]);
  }
  for (const auto& [file, content] : files) {
    written.push_back(file.string());
    text += fmt::format("written to {}\n", file.string());
  }
  session.result({{"from", name(from)},
                  {"to", name(to)},
                  {"cameras", cameras},
                  {"files", written},
                  {"lost", losses}},
                 fmt::format("{} to {}, {} camera{}:\n", name(from), name(to), rig.cameras.size(),
                             rig.cameras.size() == 1 ? "" : "s") +
                     text);
}

}  // namespace

void add_convert(CLI::App& app, Session& session) {
  auto o = std::make_shared<ConvertArguments>();
  CLI::App* verb = add_verb(
      app, session, "convert",
      "convert rigs between Vernier, mrcal, OpenCV, Kalibr, ROS and COLMAP; read those of ASL and "
      "KITTI",
      "vernier convert rig.json --to mrcal -o models/\n"
      "  vernier convert models/left.cameramodel models/right.cameramodel -o rig.json\n"
      "  vernier convert intrinsics.yml extrinsics.yml --size 640x480 --unit-m 0.001 -o rig.json\n"
      "  vernier convert calib.txt --cameras P2,P3 --size 1241x376 -o rig.json");
  const std::string formats = std::string("one of ") + rig_format_names;
  verb->add_option(
          "input", o->inputs,
          "file or files of one rig (mrcal, ROS and ASL: one per camera, left first), or a "
          "folder of COLMAP or ASL")
      ->required();
  verb->add_option("-o,--output", o->output,
                   "file, or folder (with a trailing slash) for formats with several files")
      ->required();
  verb->add_option("--from", o->from, formats + " (default: from file name and content)");
  verb->add_option(
      "--to", o->to,
      std::string("one of ") + written_rig_format_names + " (default: from the output name)");
  verb->add_option("--model", o->model,
                   "camera model (default: the smallest that represents the input exactly)");
  verb->add_option("--cameras", o->cameras,
                   "cameras to keep, in this order, such as P2,P3, with their covariance");
  verb->add_option("--names", o->names, "camera names, such as left,right");
  verb->add_option(
      "--size", o->size,
      "image size, such as 640x480, if missing in an OpenCV or KITTI file; of an OpenCV "
      "file also one of each camera, separated by commas");
  verb->add_option("--unit-m", o->unit_m, "unit of length of the input, in metres (0.001: mm)")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
