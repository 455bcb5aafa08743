// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <map>
#include <numbers>
#include <sstream>
#include <string_view>

#include "calib/error.h"
#include "sim/world_check.h"

namespace vernier {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

/// Levenshtein's distance: insertions, deletions and replacements from one word to the other.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[to.size()];
}

template <typename Words>
std::string nearest_word(std::string_view word, const Words& known) {
  std::string best;
  std::size_t best_distance = std::string::npos;
  for (const auto& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

/// Turns parsed TOML into a description. Every complaint carries the file and the line.
class Reader {
 public:
  explicit Reader(std::string place) : place_(std::move(place)) {}

  WorldDescription read(const toml::table& root);

 private:
  using Keys = std::initializer_list<std::string_view>;

  [[noreturn]] void fail(toml::source_index line,
                         const std::string& fault,
                         const std::string& remedy) const {
    throw Error(place_ + ":" + std::to_string(std::max<toml::source_index>(line, 1)), fault,
                remedy);
  }
  [[noreturn]] void fail(const toml::node& node,
                         const std::string& fault,
                         const std::string& remedy) const {
    fail(node.source().begin.line, fault, remedy);
  }

  void check_header(const toml::table& root) const;
  void check_keys(const toml::table& table, Keys known, const std::string& owner) const;
  const toml::node& required(const toml::table& table,
                             const char* key,
                             const std::string& owner) const;
  std::string text(const toml::node& node, const std::string& what) const;
  double number(const toml::node& node, const std::string& what) const;
  const toml::array& list(const toml::node& node, const std::string& what) const;
  const toml::table& table(const toml::node& node, const std::string& what) const;
  /// The tables of [[key]], none where the key is absent.
  std::vector<const toml::table*> tables(const toml::table& root, const char* key) const;
  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const toml::node& node, const std::string& what) const;

  void read_segment(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_surface(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_corner(const toml::node& node, const std::string& owner, FeatureSet& into) const;
  void read_features(const toml::table& table, const std::string& owner, FeatureSet& into) const;
  void read_loose(const toml::table& root, FeatureSet& into) const;
  WorldTemplate read_template(const toml::table& table, const std::string& what) const;
  WorldInstance read_instance(const toml::table& table, const std::string& what) const;
  RouteLeg read_route(const toml::table& table, const std::string& what) const;
  void read_templates(const toml::table& root, WorldDescription& world) const;
  void read_instances(const toml::table& root, WorldDescription& world) const;

  std::string place_;
};

void Reader::check_keys(const toml::table& table, Keys known, const std::string& owner) const {
  for (const auto& [key, value] : table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    fail(key.source().begin.line,
         "unknown key '" + std::string(key.str()) + "'" + (owner.empty() ? "" : " in " + owner),
         "did you mean '" + nearest_word(key.str(), known) + "'?");
  }
}

const toml::node& Reader::required(const toml::table& table,
                                   const char* key,
                                   const std::string& owner) const {
  const toml::node* node = table.get(key);
  if (!node) fail(table, owner + " has no '" + key + "'", "add it");
  return *node;
}

std::string Reader::text(const toml::node& node, const std::string& what) const {
  if (!node.is_string()) fail(node, what + " is not a string", "put it in quotes");
  return node.as_string()->get();
}

double Reader::number(const toml::node& node, const std::string& what) const {
  double value = 0;
  if (const auto* real = node.as_floating_point()) {
    value = real->get();
  } else if (const auto* whole = node.as_integer()) {
    value = static_cast<double>(whole->get());
  } else {
    fail(node, what + " holds something that is not a number", "write a number");
  }
  if (!std::isfinite(value)) {
    fail(node, what + " holds a number that is not finite", "write a finite number");
  }
  return value;
}

const toml::array& Reader::list(const toml::node& node, const std::string& what) const {
  if (!node.is_array()) fail(node, what + " is not a list", "write it as [ … ]");
  return *node.as_array();
}

const toml::table& Reader::table(const toml::node& node, const std::string& what) const {
  if (!node.is_table()) fail(node, what + " is not a table", "write it as a table of keys");
  return *node.as_table();
}

std::vector<const toml::table*> Reader::tables(const toml::table& root, const char* key) const {
  std::vector<const toml::table*> found;
  const toml::node* node = root.get(key);
  if (!node) return found;
  const std::string heading = std::string("[[") + key + "]]";
  if (!node->is_array()) {
    fail(*node, std::string("'") + key + "' is not a list of tables", "write " + heading);
  }
  for (const auto& entry : *node->as_array()) found.push_back(&table(entry, heading));
  return found;
}

template <int N>
Eigen::Matrix<double, N, 1> Reader::numbers(const toml::node& node, const std::string& what) const {
  const toml::array& values = list(node, what);
  if (values.size() != N) {
    fail(node, what + " has " + std::to_string(values.size()) + " numbers",
         "it takes " + std::to_string(N));
  }
  Eigen::Matrix<double, N, 1> result;
  for (int i = 0; i < N; ++i) result[i] = number(*values.get(i), what);
  return result;
}

void Reader::read_segment(const toml::node& node,
                          const std::string& owner,
                          FeatureSet& into) const {
  const std::string what = owner + " segment " + std::to_string(into.segments_m.size());
  const auto ends = numbers<6>(node, what);
  const auto fault = segment_fault(ends.head<3>(), ends.tail<3>());
  if (fault) fail(node, what + " " + fault->fault, fault->remedy);
  into.segments_m.emplace_back(ends.head<3>(), ends.tail<3>());
}

void Reader::read_surface(const toml::node& node,
                          const std::string& owner,
                          FeatureSet& into) const {
  const std::string what = owner + " surface " + std::to_string(into.surfaces_m.size());
  std::vector<Eigen::Vector3d> polygon;
  for (const auto& point : list(node, what)) polygon.push_back(numbers<3>(point, what + " point"));
  const auto fault = surface_fault(polygon);
  if (fault) fail(node, what + " " + fault->fault, fault->remedy);
  into.surfaces_m.push_back(std::move(polygon));
}

void Reader::read_corner(const toml::node& node, const std::string& owner, FeatureSet& into) const {
  const std::string what = owner + " corner " + std::to_string(into.corners_m.size());
  into.corners_m.push_back(numbers<3>(node, what));
}

void Reader::read_features(const toml::table& table,
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

void Reader::read_loose(const toml::table& root, FeatureSet& into) const {
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

WorldTemplate Reader::read_template(const toml::table& table, const std::string& what) const {
  check_keys(table, {"name", "segments", "surfaces", "corners"}, "[[template]]");
  WorldTemplate result;
  const toml::node& name = required(table, "name", what);
  result.name = text(name, what + " name");
  if (result.name.empty()) fail(name, what + " has an empty name", "name it");
  read_features(table, "template '" + result.name + "'", result.features);
  return result;
}

void Reader::read_templates(const toml::table& root, WorldDescription& world) const {
  std::map<std::string, toml::source_index> lines;
  for (const auto* entry : tables(root, "template")) {
    world.templates.push_back(
        read_template(*entry, "template " + std::to_string(world.templates.size())));
    const std::string& name = world.templates.back().name;
    const auto [first, is_new] = lines.emplace(name, entry->source().begin.line);
    if (!is_new) {
      fail(*entry,
           "template '" + name + "' is already defined in line " + std::to_string(first->second),
           "rename one of the two");
    }
  }
}

WorldInstance Reader::read_instance(const toml::table& table, const std::string& what) const {
  check_keys(table, {"template", "at_m", "yaw_deg"}, "[[instance]]");
  WorldInstance instance;
  instance.template_name = text(required(table, "template", what), what + " template");
  instance.at_m = numbers<3>(required(table, "at_m", what), what + " at_m");
  if (const auto* yaw = table.get("yaw_deg")) {
    instance.yaw_rad = number(*yaw, what + " yaw_deg") * rad_per_deg;
  }
  return instance;
}

void Reader::read_instances(const toml::table& root, WorldDescription& world) const {
  std::vector<std::string> names;
  for (const auto& entry : world.templates) names.push_back(entry.name);
  std::sort(names.begin(), names.end());
  for (const auto* entry : tables(root, "instance")) {
    const std::string what = "instance " + std::to_string(world.instances.size());
    world.instances.push_back(read_instance(*entry, what));
    const std::string& name = world.instances.back().template_name;
    if (std::binary_search(names.begin(), names.end(), name)) continue;
    fail(*entry->get("template"), what + " names the unknown template '" + name + "'",
         names.empty() ? "define it in a [[template]]"
                       : "did you mean '" + nearest_word(name, names) + "'?");
  }
}

RouteLeg Reader::read_route(const toml::table& table, const std::string& what) const {
  check_keys(table, {"points_m"}, "[[route]]");
  RouteLeg leg;
  const toml::node& points = required(table, "points_m", what);
  for (const auto& point : list(points, what + " points_m")) {
    leg.points_m.push_back(numbers<2>(point, what + " point"));
  }
  const auto fault = route_fault(leg.points_m);
  if (fault) fail(points, what + " " + fault->fault, fault->remedy);
  return leg;
}

void Reader::check_header(const toml::table& root) const {
  const toml::node* format = root.get("format");
  if (!format) fail(1, "the file names no format", "begin it with format = \"vernier/world\"");
  const std::string kind = text(*format, "format");
  if (kind != "vernier/world") {
    fail(*format, "this is '" + kind + "', not a world", "give a file of format vernier/world");
  }
  const toml::node* version = root.get("version");
  if (!version) fail(1, "the file has no version", "write version = 1");
  if (!version->is_integer() || version->as_integer()->get() != 1) {
    std::ostringstream is;
    version->visit([&](const auto& value) { is << value; });
    fail(*version, "version " + is.str() + " is not known here", "this program reads version 1");
  }
}

WorldDescription Reader::read(const toml::table& root) {
  check_header(root);
  // [[view_dependency]] belongs to the visibility that reads it, and is no fault here.
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
  return world;
}

}  // namespace

WorldDescription parse_world(const std::string& text, const std::string& place) {
  toml::table root;
  try {
    root = toml::parse(std::string_view(text));
  } catch (const toml::parse_error& error) {
    throw Error(place + ":" + std::to_string(error.source().begin.line),
                "not TOML: " + std::string(error.description()), "mend the syntax");
  }
  return Reader(place).read(root);
}

WorldDescription read_world(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  // Streaming an empty file sets failbit on the target, which is no fault of the source.
  if (stream && stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (stream.bad() || !stream.is_open() || std::filesystem::is_directory(file)) {
    throw Error(file.string(), "cannot be read", "check the path and its permissions");
  }
  return parse_world(text.str(), file.string());
}

}  // namespace vernier
