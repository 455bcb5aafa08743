// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/mrcal_cameramodel.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/python_literal.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

using Kind = PythonLiteral::Kind;

struct LensModel {
  const char* name;
  std::size_t coefficients;
};
constexpr LensModel lens_models[] = {{"LENSMODEL_PINHOLE", 0},
                                     {"LENSMODEL_OPENCV4", 4},
                                     {"LENSMODEL_OPENCV5", 5},
                                     {"LENSMODEL_OPENCV8", 8},
                                     {"LENSMODEL_OPENCV12", 12}};
constexpr double most_angle_rad = 1'000;  ///< of a rotation vector's component

/// The value of the first of these names of a key (mrcal renamed some) that is present.
const PythonLiteral* find_any(const PythonLiteral& model,
                              std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (const PythonLiteral* value = model.find(name)) return value;
  }
  return nullptr;
}

const PythonLiteral& required(const PythonLiteral* value,
                              const std::string& key,
                              const std::string& place) {
  if (value) return *value;
  throw Error(place, "has no '" + key + "'", "give a whole mrcal cameramodel");
}

std::vector<double> numbers(const PythonLiteral& value,
                            std::size_t count,
                            const std::string& key,
                            const std::string& file) {
  const std::string place = fmt::format("{}:{}: {}", file, value.line, key);
  if (value.kind != Kind::list || value.items.size() != count) {
    throw Error(place,
                value.kind == Kind::list
                    ? fmt::format("holds {} values, not {}", value.items.size(), count)
                    : "is not a list",
                fmt::format("give {} numbers", count));
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    if (value.items[i].kind != Kind::number || !std::isfinite(value.items[i].number)) {
      throw Error(fmt::format("{}[{}]", place, i), "is not a finite number", "correct it");
    }
    out.push_back(value.items[i].number);
  }
  return out;
}

std::size_t coefficient_count(const PythonLiteral& value, const std::string& file) {
  std::string name = value.text;
  if (name.rfind("DISTORTION_", 0) == 0) name.replace(0, 10, "LENSMODEL");  // before mrcal 1.0
  if (name == "LENSMODEL_NONE") name = "LENSMODEL_PINHOLE";                 // likewise
  for (const LensModel& model : lens_models) {
    if (name == model.name) return model.coefficients;
  }
  throw Error(fmt::format("{}:{}: lensmodel", file, value.line),
              "unsupported lens model" + (name.empty() ? "" : " " + shortened(name)),
              "convert it in mrcal first (mrcal-convert-lensmodel) to LENSMODEL_OPENCV8 or a "
              "smaller one");
}

/// mrcal's name for a camera's coefficients. Throws Error where it has no model with so many.
std::string lens_name(const Camera& camera, std::size_t coefficients) {
  for (const LensModel& model : lens_models) {
    if (model.coefficients == coefficients) return model.name;
  }
  throw Error(fmt::format("camera \"{}\"", camera.name),
              fmt::format("mrcal has no lens model like {}", model_name(camera.model)),
              "calibrate with opencv8, or choose another format");
}

Eigen::Vector2i image_size(const PythonLiteral& model, const std::string& file) {
  const PythonLiteral& value = required(model.find("imagersize"), "imagersize", file);
  const std::vector<double> size = numbers(value, 2, "imagersize", file);
  for (const double s : size) {
    if (!(s >= 1 && s <= 1e6) || s != std::round(s)) {
      throw Error(fmt::format("{}:{}: imagersize", file, value.line), "is not [width, height]",
                  "give two whole numbers above 0");
    }
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

Pose pose(const PythonLiteral& model, const std::string& file, double unit_m) {
  const PythonLiteral* newer = model.find("rt_cam_ref");
  const PythonLiteral* older = model.find("extrinsics");
  const char* key = newer ? "rt_cam_ref" : "extrinsics";
  const PythonLiteral& value = required(newer ? newer : older, "extrinsics", file);
  const std::vector<double> rt = numbers(value, 6, key, file);
  if (newer && older && numbers(*older, 6, "extrinsics", file) != rt) {
    throw Error(fmt::format("{}:{}: extrinsics", file, older->line), "differs from rt_cam_ref",
                "leave one of them out");
  }
  const std::string place = fmt::format("{}:{}: {}", file, value.line, key);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(rt[i]) > most_angle_rad) {
      throw Error(place, fmt::format("a rotation is beyond {:g} rad", most_angle_rad),
                  "correct it");
    }
  }
  return {rotation_from_vector({rt[0], rt[1], rt[2]}),
          translation({rt[3], rt[4], rt[5]}, unit_m, place)};
}

}  // namespace

PlacedCamera parse_mrcal_cameramodel(const std::string& text,
                                     const std::string& place,
                                     const ImportOptions& options,
                                     std::vector<std::string>& notes) {
  const PythonLiteral model = parse_python_literal(text, place);
  if (model.kind != Kind::dictionary) {
    throw Error(place, "is not an mrcal cameramodel: it has no { … }", "name another file");
  }
  const PythonLiteral& lens = required(
      find_any(model, {"lensmodel", "lens_model", "distortion_model"}), "lensmodel", place);
  const std::size_t count = coefficient_count(lens, place);
  const std::vector<double> values = numbers(
      required(model.find("intrinsics"), "intrinsics", place), 4 + count, "intrinsics", place);
  const Camera camera = camera_from_opencv(
      {values[0], values[1], values[2], values[3], false, {values.begin() + 4, values.end()}},
      image_size(model, place), place + ": intrinsics", options.model);
  for (const char* key : {"optimization_inputs", "valid_intrinsics_region"}) {
    if (model.find(key)) notes.push_back(fmt::format("{}: {} is ignored", place, key));
  }
  return {camera, pose(model, place, options.unit_m)};
}

ImportedRig read_mrcal_cameramodels(const std::vector<std::filesystem::path>& files,
                                    const ImportOptions& options) {
  ImportedRig imported;
  std::vector<PlacedCamera> cameras;
  for (const std::filesystem::path& file : files) {
    cameras.push_back(
        parse_mrcal_cameramodel(read_whole(file), file.string(), options, imported.notes));
    cameras.back().camera.name = file.stem().string();
  }
  imported.rig = rig_of(std::move(cameras));
  return imported;
}

std::vector<ExportedFile> mrcal_cameramodels(const Rig& rig) {
  std::vector<ExportedFile> files;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const Camera& camera = rig.cameras[i];
    const OpenCvIntrinsics in = opencv_intrinsics(camera);
    if (in.fisheye) {
      throw Error(fmt::format("camera \"{}\"", camera.name),
                  "mrcal has no lens model like fisheye4",
                  "calibrate with opencv8, or choose another format");
    }
    std::vector<double> intrinsics{in.fx_px, in.fy_px, in.cx_px, in.cy_px};
    intrinsics.insert(intrinsics.end(), in.coefficients.begin(), in.coefficients.end());
    const Eigen::Vector3d r = vector_from_rotation(rig.T_camera_first[i].R);
    const Eigen::Vector3d& t = rig.T_camera_first[i].t;
    const std::string rt =
        fmt::format("{}, {}, {}, {}, {}, {}", r[0], r[1], r[2], t[0], t[1], t[2]);
    const std::string lens = lens_name(camera, in.coefficients.size());
    files.push_back(
        {file_stem(camera) + ".cameramodel",
         fmt::format("{{\n    'lensmodel':  '{}',\n\n"
                     "    # fx, fy, cx, cy, then the distortion\n    'intrinsics': [ {} ],\n\n"
                     "    # x_camera = exp([r]x) x_reference + t, under its older and its "
                     "newer name\n"
                     "    'extrinsics': [ {} ],\n    'rt_cam_ref': [ {} ],\n\n"
                     "    'imagersize': [ {}, {} ],\n}}\n",
                     lens, fmt::join(intrinsics, ", "), rt, rt, camera.size_px[0],
                     camera.size_px[1])});
  }
  return files;
}

}  // namespace vernier::internal
