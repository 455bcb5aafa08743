// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/stereo_scenes.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/map_window.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

DisparityMap read_map(const std::filesystem::path& file,
                      const StereoSceneFile& scene,
                      int width_px,
                      int height_px) {
  DisparityFileOptions options;
  options.scale = scene.truth_scale;
  if (scene.truth_unknown) options.unknown = *scene.truth_unknown;
  DisparityMap map = read_disparity(file, options);
  if (map.width_px != width_px || map.height_px != height_px) {
    throw Error(file.string(),
                "the size " + fmt::format("{}x{}", map.width_px, map.height_px) +
                    " differs from that of the images, " +
                    fmt::format("{}x{}", width_px, height_px),
                "use the ground truth of these images");
  }
  check_known(map, file.string());
  return map;
}

constexpr std::array<std::string_view, 4> truth_kinds = {"exact", "measured", "reduced",
                                                         "labelled"};
constexpr int max_disparity_px = 1 << 15;

/// Converts the tables of a list to pairs. Every error has the file and the line.
class SceneReader : private TomlReader {
 public:
  explicit SceneReader(const std::filesystem::path& file)
      : TomlReader(file.string()), folder_(file.parent_path()) {}

  std::vector<StereoSceneFile> read(const toml::table& root) {
    check_keys(root, {"pair"}, "");
    std::vector<StereoSceneFile> scenes;
    for (const toml::table* pair : tables(root, "pair")) scenes.push_back(scene(*pair));
    if (scenes.empty()) fail(root, "lists no pair", "add a [[pair]]");
    return scenes;
  }

 private:
  StereoSceneFile scene(const toml::table& pair) {
    check_keys(pair,
               {"name", "left", "right", "truth", "right_truth", "truth_scale", "truth_unknown",
                "truth_kind", "min_disparity", "max_disparity", "rig"},
               "[[pair]]");
    StereoSceneFile scene;
    const toml::node& name = required(pair, "name", "[[pair]]");
    scene.name = text(name, "name");
    if (scene.name.empty()) fail(name, "name is empty", "add a name");
    if (!names_.insert(scene.name).second) {
      fail(name, "duplicate name '" + shortened(scene.name) + "'", "rename one of the pairs");
    }
    const std::string owner = "pair '" + shortened(scene.name) + "'";
    scene.left = file_of(required(pair, "left", owner), "left");
    scene.right = file_of(required(pair, "right", owner), "right");
    scene.truth = file_of(required(pair, "truth", owner), "truth");
    if (const auto* node = pair.get("right_truth"))
      scene.right_truth = file_of(*node, "right_truth");
    if (const auto* node = pair.get("rig")) scene.rig = file_of(*node, "rig");
    if (const auto* node = pair.get("truth_scale")) {
      scene.truth_scale = number(*node, "truth_scale");
      if (!(scene.truth_scale > 0)) {
        fail(*node, "truth_scale is not positive", "give the file values per pixel of disparity");
      }
    }
    if (const auto* node = pair.get("truth_unknown")) {
      const bool none = node->is_string() && text(*node, "truth_unknown") == "none";
      scene.truth_unknown =
          none ? std::numeric_limits<double>::quiet_NaN() : number(*node, "truth_unknown");
    }
    if (const auto* node = pair.get("truth_kind")) scene.truth_kind = kind(*node);
    scene.range = range(pair, owner);
    return scene;
  }

  DisparityRange range(const toml::table& pair, const std::string& owner) const {
    const toml::node& most = required(pair, "max_disparity", owner);
    const toml::node* least = pair.get("min_disparity");
    const DisparityRange range{least ? disparity(*least, "min_disparity") : 0,
                               disparity(most, "max_disparity")};
    if (range.min_px > range.max_px) {
      fail(most, "max_disparity is below min_disparity", "give the search range");
    }
    return range;
  }

  int disparity(const toml::node& node, const char* key) const {
    const std::int64_t value = integer(node, key);
    if (value < -max_disparity_px || value > max_disparity_px) {
      fail(node, std::string(key) + " is out of range", "give a disparity in pixels");
    }
    return static_cast<int>(value);
  }

  TruthKind kind(const toml::node& node) const {
    const std::string word = text(node, "truth_kind");
    for (std::size_t i = 0; i < truth_kinds.size(); ++i) {
      if (word == truth_kinds[i]) return static_cast<TruthKind>(i);
    }
    fail(node, "unknown truth_kind '" + shortened(word) + "'",
         "use exact, measured, reduced or labelled");
  }

  std::filesystem::path file_of(const toml::node& node, const char* key) const {
    std::filesystem::path file = folder_ / file_name(node, key);
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown) || std::filesystem::is_directory(file, unknown)) {
      fail(node, std::string(key) + ": no such file: " + file.string(),
           "give the path relative to the list");
    }
    return file;
  }

  std::filesystem::path folder_;
  std::set<std::string> names_;
};

}  // namespace

std::string_view name(TruthKind kind) { return truth_kinds[static_cast<std::size_t>(kind)]; }

std::vector<StereoSceneFile> read_stereo_scenes(const std::filesystem::path& file) {
  const toml::table root = parse_toml(read_whole(file), file.string());
  return SceneReader(file).read(root);
}

StereoTruth read_stereo_truth(const StereoSceneFile& scene, int width_px, int height_px) {
  DisparityMap left = read_map(scene.truth, scene, width_px, height_px);
  if (scene.right_truth.empty()) return stereo_truth(std::move(left));
  const DisparityMap right = read_map(scene.right_truth, scene, width_px, height_px);
  return stereo_truth(std::move(left), &right);
}

}  // namespace vernier::stereo::internal
