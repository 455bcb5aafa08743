// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/colmap_cameras.h"
#include "calib/formats/imported_rig.h"
#include "calib/rig.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

/// The file of that name among those of three cameras.
std::string example_colmap_file(const std::string& name, const std::string& model, int cameras) {
  for (const ExportedFile& file : colmap_cameras(example_rig(model, cameras))) {
    if (file.name == name) return file.text;
  }
  return "";
}

void run_model(std::string_view bytes, const std::string& name) {
  clear_input_folder();
  if (name != "cameras.txt") {
    input_file(example_colmap_file("cameras.txt", "opencv4", 3), "cameras.txt");
  }
  if (name == "rig_config.json") {
    input_file(example_colmap_file("images.txt", "opencv4", 3), "images.txt");
  }
  input_file(bytes, name);
  const std::filesystem::path folder = input_folder();
  const auto imported = accepted([&] { return read_colmap_cameras(folder); });
  if (!imported) return;
  const auto files = accepted([&] { return colmap_cameras(imported->rig); });
  if (!files) return;
  clear_input_folder();
  for (const ExportedFile& file : *files) input_file(file.text, file.name.string());
  require_close(imported->rig, read_colmap_cameras(folder).rig);
}

void run_colmap_cameras(std::string_view bytes) { run_model(bytes, "cameras.txt"); }
void run_colmap_images(std::string_view bytes) { run_model(bytes, "images.txt"); }
void run_colmap_rigs(std::string_view bytes) { run_model(bytes, "rigs.txt"); }
void run_colmap_rig_config(std::string_view bytes) { run_model(bytes, "rig_config.json"); }

std::vector<std::string> colmap_cameras_seeds() {
  std::vector<std::string> seeds;
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv8", "fisheye4"}) {
    seeds.push_back(example_colmap_file("cameras.txt", model, 1));
  }
  return seeds;
}

std::vector<std::string> colmap_images_seeds() {
  return {example_colmap_file("images.txt", "opencv4", 3)};
}

std::vector<std::string> colmap_rig_config_seeds() {
  return {example_colmap_file("rig_config.json", "opencv4", 3)};
}

/// Vernier reads COLMAP's own rigs.txt and writes rig_config.json instead.
std::vector<std::string> colmap_rigs_seeds() {
  return {
      "# RIG_ID NUM_SENSORS REF_SENSOR_TYPE REF_SENSOR_ID SENSORS[]\n"
      "1 3 CAMERA 1 CAMERA 2 1 0.9999 0.005 -0.01 0.0025 -0.2 0.002 -0.003 "
      "CAMERA 3 1 0.9998 0.01 -0.01 0.0025 -0.4 0.002 -0.003\n"};
}

const Registered registered_colmap_cameras{
    {"colmap_cameras", 1000, "colmap", run_colmap_cameras, colmap_cameras_seeds}};
const Registered registered_colmap_images{
    {"colmap_images", 2000, "colmap", run_colmap_images, colmap_images_seeds}};
const Registered registered_colmap_rigs{
    {"colmap_rigs", 2000, "colmap", run_colmap_rigs, colmap_rigs_seeds}};
const Registered registered_colmap_rig_config{
    {"colmap_rig_config", 4000, "colmap", run_colmap_rig_config, colmap_rig_config_seeds}};

}  // namespace
}  // namespace vernier::fuzz
