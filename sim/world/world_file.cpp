// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world_file.h"

#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "calib/base/small_letters.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "sim/world.h"
#include "sim/world/world_check.h"
#include "sim/world/written_rows.h"

namespace vernier::sim {

using namespace internal;
using namespace vernier::internal;

namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

/// Converts parsed TOML to a description. Every error has the file and the line.
class WorldReader : private TomlReader {
 public:
  using TomlReader::TomlReader;
  WorldDescription read(const toml::table& root);

 private:
  void check_header(const toml::table& root) const;
  void read_segment(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_surface(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_corner(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_features(const toml::table& table, const std::string& owner, FeatureSet& into) const;
  void read_loose(const toml::table& root, FeatureSet& into) const;
  WorldTemplate read_template(const toml::table& table, const std::string& what) const;
  WorldInstance read_instance(const toml::table& table, const std::string& what) const;
  RouteLeg read_route(const toml::table& table, const std::string& what) const;
  ViewSet read_view_set(const toml::table& table, const std::string& what) const;
  void read_templates(const toml::table& root, WorldDescription& world) const;
  void read_instances(const toml::table& root, WorldDescription& world) const;
};

void WorldReader::read_segment(const toml::node& node,
                               const std::string& owner,
                               FeatureSet& into) const {
  const std::string what = owner + " segment " + std::to_string(into.segments_m.size());
  const auto ends = numbers<6>(node, what);
  const auto fault = segment_error(ends.head<3>(), ends.tail<3>());
  if (fault) fail(node, what + " " + fault->fault, fault->remedy);
  into.segments_m.emplace_back(ends.head<3>(), ends.tail<3>());
}

void WorldReader::read_surface(const toml::node& node,
                               const std::string& owner,
                               FeatureSet& into) const {
  const std::string what = owner + " surface " + std::to_string(into.surfaces_m.size());
  std::vector<Eigen::Vector3d> polygon;
  for (const auto& point : list(node, what)) polygon.push_back(numbers<3>(point, what + " point"));
  const auto fault = surface_error(polygon);
  if (fault) fail(node, what + " " + fault->fault, fault->remedy);
  into.surfaces_m.push_back(std::move(polygon));
}

void WorldReader::read_corner(const toml::node& node,
                              const std::string& owner,
                              FeatureSet& into) const {
  const std::string what = owner + " corner " + std::to_string(into.corners_m.size());
  into.corners_m.push_back(numbers<3>(node, what));
  const auto fault = point_error(into.corners_m.back());
  if (fault) fail(node, what + " " + fault->fault, fault->remedy);
}

void WorldReader::read_features(const toml::table& table,
                                const std::string& owner,
                                FeatureSet& into) const {
  if (const auto* node = table.get("segments")) {
    for (const auto& entry : list(*node, owner + " segments")) read_segment(entry, owner, into);
  }
  if (const auto* node = table.get("surfaces")) {
    for (const auto& entry : list(*node, owner + " surfaces")) read_surface(entry, owner, into);
  }
  if (const auto* node = table.get("corners")) {
    for (const auto& entry : list(*node, owner + " corners")) read_corner(entry, owner, into);
  }
}

void WorldReader::read_loose(const toml::table& root, FeatureSet& into) const {
  if (const auto* node = root.get("loose")) {
    const toml::table& loose = table(*node, "[loose]");
    check_keys(loose, {"segments", "surfaces", "corners"}, "[loose]");
    read_features(loose, "loose", into);
  }
  for (const auto* entry : tables(root, "segment")) {
    check_keys(*entry, {"segment"}, "[[segment]]");
    read_segment(required(*entry, "segment", "[[segment]]"), "loose", into);
  }
  for (const auto* entry : tables(root, "surface")) {
    check_keys(*entry, {"polygon"}, "[[surface]]");
    read_surface(required(*entry, "polygon", "[[surface]]"), "loose", into);
  }
  for (const auto* entry : tables(root, "corner")) {
    check_keys(*entry, {"at_m"}, "[[corner]]");
    read_corner(required(*entry, "at_m", "[[corner]]"), "loose", into);
  }
}

WorldTemplate WorldReader::read_template(const toml::table& table, const std::string& what) const {
  check_keys(table, {"name", "segments", "surfaces", "corners"}, "[[template]]");
  WorldTemplate result;
  const toml::node& name = required(table, "name", what);
  result.name = text(name, what + " name");
  if (result.name.empty()) fail(name, what + " has an empty name", "add a name");
  read_features(table, "template '" + shortened(result.name) + "'", result.features);
  return result;
}

void WorldReader::read_templates(const toml::table& root, WorldDescription& world) const {
  std::map<std::string, toml::source_index> lines;
  for (const auto* entry : tables(root, "template")) {
    world.templates.push_back(
        read_template(*entry, "template " + std::to_string(world.templates.size())));
    const std::string& name = world.templates.back().name;
    const auto [first, is_new] = lines.emplace(name, entry->source().begin.line);
    if (!is_new) {
      fail(*entry,
           "template '" + shortened(name) + "' is already defined in line " +
               std::to_string(first->second),
           "rename one of the two");
    }
  }
}

WorldInstance WorldReader::read_instance(const toml::table& table, const std::string& what) const {
  check_keys(table, {"template", "at_m", "yaw_deg"}, "[[instance]]");
  WorldInstance instance;
  instance.template_name = text(required(table, "template", what), what + " template");
  instance.at_m = numbers<3>(required(table, "at_m", what), what + " at_m");
  if (const auto* yaw = table.get("yaw_deg")) {
    instance.yaw_rad = number(*yaw, what + " yaw_deg") * rad_per_deg;
  }
  return instance;
}

void WorldReader::read_instances(const toml::table& root, WorldDescription& world) const {
  std::vector<std::string_view> names;
  std::map<std::string_view, double> reaches_m;
  for (const auto& entry : world.templates) {
    names.push_back(entry.name);
    reaches_m[entry.name] = reach_m(entry.features);
  }
  for (const auto* entry : tables(root, "instance")) {
    const std::string what = "instance " + std::to_string(world.instances.size());
    world.instances.push_back(read_instance(*entry, what));
    const std::string& name = world.instances.back().template_name;
    if (const auto found = reaches_m.find(name); found != reaches_m.end()) {
      const auto fault = instance_error(world.instances.back(), found->second);
      if (fault) fail(*entry, what + " " + fault->fault, fault->remedy);
      continue;
    }
    fail(*entry->get("template"),
         what + " refers to the unknown template '" + shortened(name) + "'",
         names.empty() ? "define it in a [[template]]" : unknown_word_remedy(name, names));
  }
}

RouteLeg WorldReader::read_route(const toml::table& table, const std::string& what) const {
  check_keys(table, {"points_m"}, "[[route]]");
  RouteLeg leg;
  const toml::node& points = required(table, "points_m", what);
  for (const auto& point : list(points, what + " points_m")) {
    leg.points_m.push_back(numbers<2>(point, what + " point"));
  }
  const auto fault = route_error(leg.points_m);
  if (fault) fail(points, what + " " + fault->fault, fault->remedy);
  return leg;
}

ViewSet WorldReader::read_view_set(const toml::table& table, const std::string& what) const {
  check_keys(table, {"at_m", "heading_deg", "segments"}, "[[view_dependency]]");
  const Eigen::Vector2d at = numbers<2>(required(table, "at_m", what), what + " at_m");
  const double heading =
      number(required(table, "heading_deg", what), what + " heading_deg") * rad_per_deg;
  ViewSet set{{at.x(), at.y(), heading}, {}};
  for (const auto& index : list(required(table, "segments", what), what + " segments")) {
    const std::int64_t segment = integer(index, what + " segment");
    if (segment < 0 || segment > std::numeric_limits<int>::max() ||
        (!set.segments.empty() && segment <= set.segments.back())) {
      fail(index, what + " segment " + std::to_string(segment) + " is not larger than the last",
           "give ascending indices, from 0");
    }
    set.segments.push_back(static_cast<int>(segment));
  }
  return set;
}

void WorldReader::check_header(const toml::table& root) const {
  const toml::node* format = root.get("format");
  if (!format) fail(1, "the file has no format", "add format = \"vernier/world\"");
  const std::string kind = text(*format, "format");
  if (kind != "vernier/world") {
    fail(*format, "the format is '" + kind + "'", "use a file of format vernier/world");
  }
  const toml::node* version = root.get("version");
  if (!version) fail(1, "the file has no version", "add version = 1");
  if (!version->is_integer() || version->as_integer()->get() != 1) {
    fail(*version, "version " + shortened(shown_value(*version)) + " is not supported",
         "supported: 1");
  }
}

WorldDescription WorldReader::read(const toml::table& root) {
  check_header(root);
  check_keys(root,
             {"format", "version", "name", "template", "instance", "loose", "segment", "surface",
              "corner", "route", "view_dependency"},
             "");
  WorldDescription world;
  if (const auto* name = root.get("name")) world.name = text(*name, "name");
  read_templates(root, world);
  read_instances(root, world);
  read_loose(root, world.loose);
  for (const auto* entry : tables(root, "route")) {
    world.route.push_back(read_route(*entry, "route " + std::to_string(world.route.size())));
  }
  for (const auto* entry : tables(root, "view_dependency")) {
    world.view_sets.push_back(
        read_view_set(*entry, "view_dependency " + std::to_string(world.view_sets.size())));
  }
  if (const auto fault = size_error(world)) throw Error(place(), fault->fault, fault->remedy);
  return world;
}

WorldDescription read_tables_and_rows(const std::string& text, const std::string& place) {
  std::optional<WrittenRows> written = take_written_rows(text);
  if (!written) return WorldReader(place).read(parse_toml(text, place));
  WorldDescription world = WorldReader(place).read(parse_toml(written->rest, place));
  // A list that was taken is empty in the rest; what else the file adds comes after it.
  const auto join = [](auto& first, auto& then) {
    first.insert(first.end(), std::make_move_iterator(then.begin()),
                 std::make_move_iterator(then.end()));
    then = std::move(first);
  };
  FeatureSet& taken = written->features;
  join(taken.segments_m, world.loose.segments_m);
  join(taken.surfaces_m, world.loose.surfaces_m);
  join(taken.corners_m, world.loose.corners_m);
  if (const auto fault = size_error(world)) throw Error(place, fault->fault, fault->remedy);
  return world;
}

}  // namespace

WorldDescription parse_world(const std::string& text, const std::string& place) {
  const std::string written = small_letters(std::filesystem::path(place).extension().string());
  for (const char* ending : {".obj", ".ply", ".dae", ".zae", ".ifc", ".ifczip", ".gltf", ".glb",
                             ".stl", ".fbx", ".3ds"}) {
    if (written != ending) continue;
    throw Error(place, "is a mesh, not a world file", "import it first: vernier world import");
  }
  WorldDescription world = read_tables_and_rows(text, place);
  if (const auto fault = floor_error(world)) throw Error(place, fault->fault, fault->remedy);
  return world;
}

WorldDescription read_world(const std::filesystem::path& file) {
  return parse_world(read_whole(file), file.string());
}

}  // namespace vernier::sim
