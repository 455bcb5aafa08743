// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "calib/error.h"
#include "sim/buildings/office.h"
#include "sim/world.h"
#include "sim/world/written_rows.h"

namespace vernier {

using namespace vernier::sim;
using sim::internal::make_office;
using sim::internal::take_written_rows;

namespace {

const std::string kHead = "format = \"vernier/world\"\nversion = 1\n";  // lines 1 and 2

std::string message_of(const std::string& text) {
  try {
    parse_world(text, "w.world.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

WorldDescription small_world() {
  WorldDescription world;
  world.name = "a \"quoted\\\" name\t";
  WorldTemplate door{"door", {}};
  door.features.segments_m = {{{0, 0, 0}, {0, 0, 2.05}}, {{-1e-6, 1.0 / 3, 2.05}, {0.9, 0, 2.05}}};
  door.features.surfaces_m = {{{0, 0, 0}, {0.9, 0, 0}, {0.9, 0, 2.05}, {0, 0, 2.05}}};
  door.features.corners_m = {{0, 0, 2.05}};
  world.templates = {door};
  world.instances = {{"door", {4, 2.5, 0}, std::numbers::pi / 2}, {"door", {1, 1, 0}, -0.1}};
  world.loose.segments_m = {{{0, 0, 0}, {20, 0, 0}}};
  world.route = {{{{0.6, 7.5}, {19.4, 7.5}}}};
  return world;
}

TEST(WorldFile, WritesPlainShortNumbers) {
  EXPECT_EQ(format_world(small_world()), R"(format = "vernier/world"
version = 1
name = "a \"quoted\\\" name\u0009"

[[template]]
name = "door"
segments = [
  [0, 0, 0, 0, 0, 2.05],
  [0, 0.3333, 2.05, 0.9, 0, 2.05],
]
surfaces = [
  [[0, 0, 0], [0.9, 0, 0], [0.9, 0, 2.05], [0, 0, 2.05]],
]
corners = [
  [0, 0, 2.05],
]

[[instance]]
template = "door"
at_m = [4, 2.5, 0]
yaw_deg = 90

[[instance]]
template = "door"
at_m = [1, 1, 0]
yaw_deg = -5.7296

[loose]
segments = [
  [0, 0, 0, 20, 0, 0],
]

[[route]]
points_m = [[0.6, 7.5], [19.4, 7.5]]
)");
}

TEST(WorldFile, RoundTripKeepsEveryByte) {
  const std::string text = format_world(small_world());
  const WorldDescription again = parse_world(text, "text");
  EXPECT_EQ(again.name, small_world().name);
  EXPECT_EQ(format_world(again), text);
}

TEST(WorldFile, WritesByRenameAndReadsBack) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "vernier_world_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto file = folder / "small.world.toml";
  write_world(small_world(), file);
  write_world(small_world(), file);
  EXPECT_EQ(text_of(file), format_world(small_world()));
  EXPECT_EQ(format_world(read_world(file)), format_world(small_world()));
  const auto entries = std::distance(std::filesystem::directory_iterator(folder), {});
  EXPECT_EQ(entries, 1) << "a temporary file was left";
  std::filesystem::remove_all(folder);
}

TEST(WorldFile, SaysWhichFileCannotBeWrittenOrRead) {
  const auto file = std::filesystem::path(testing::TempDir()) / "vernier_no_such" / "w.world.toml";
  EXPECT_THROW(write_world(small_world(), file), Error);
  EXPECT_THROW(read_world(file), Error);
  EXPECT_THROW(read_world(testing::TempDir()), Error);
}

TEST(WorldFile, RefusesToWriteWhatCannotBeRead) {
  WorldDescription world = small_world();
  world.loose.segments_m = {{{0, 0, 0}, {0.00104, 0, 0}}};
  EXPECT_NO_THROW(parse_world(format_world(world), "text"));
  world.loose.segments_m = {{{0.00004, 0, 0}, {0.00104, 0, 0}}};
  EXPECT_NO_THROW(parse_world(format_world(world), "text"));
  world.loose.segments_m = {{{0, 0, 0}, {0.00094, 0, 0}}};
  EXPECT_THROW(format_world(world), Error);
  world.loose.segments_m = {{{0, 0, 0}, {1e12, 0, 0}}};
  EXPECT_THROW(format_world(world), Error);
}

TEST(WorldFile, ReadsTheExampleOfTheDesign) {
  const WorldDescription world = parse_world(kHead + R"([[template]]
name = "door"
segments = [[0,0,0, 0,0,2.05], [0.9,0,0, 0.9,0,2.05], [0,0,2.05, 0.9,0,2.05]]
surfaces = [[[0,0,0], [0.9,0,0], [0.9,0,2.05], [0,0,2.05]]]
[[instance]]
template = "door"
at_m = [4.0, 2.5, 0.0]
yaw_deg = 90
[[segment]]
segment = [0, 0, 0, 1, 0, 0]
[[surface]]
polygon = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
[[corner]]
at_m = [1, 0, 0]
[[view_dependency]]
at_m = [0, 0]
heading_deg = 90
segments = [0, 2]
)",
                                             "text");
  EXPECT_EQ(world.templates[0].features.segments_m.size(), 3u);
  EXPECT_DOUBLE_EQ(world.instances[0].yaw_rad, std::numbers::pi / 2);
  EXPECT_EQ(world.loose.segments_m.size(), 1u);
  EXPECT_EQ(world.loose.surfaces_m.size(), 1u);
  EXPECT_EQ(world.loose.corners_m.size(), 1u);
}

TEST(WorldFile, LooseTableComesBeforeSingleFeatures) {
  const WorldDescription world = parse_world(kHead + R"([[segment]]
segment = [5, 0, 0, 6, 0, 0]
[loose]
segments = [[0, 0, 0, 1, 0, 0]]
)",
                                             "text");
  ASSERT_EQ(world.loose.segments_m.size(), 2u);
  EXPECT_EQ(world.loose.segments_m[1].first.x(), 5);
}

struct Fault {
  const char* text;
  const char* message;
};

/// A world of more than 1 MB whose features are all loose, as imported meshes are.
std::string long_text() {
  const World office = build_world(make_office(1, {.size_m = {40, 15, 2.5}}));
  WorldDescription flat;
  for (const WorldSegment& s : office.segments) flat.loose.segments_m.emplace_back(s.a_m, s.b_m);
  for (const WorldSurface& s : office.surfaces) flat.loose.surfaces_m.push_back(s.polygon_m);
  for (const WorldCorner& c : office.corners) flat.loose.corners_m.push_back(c.position_m);
  flat.route = office.route;
  return format_world(flat);
}

// Rows as they are written are read at once, all others by the TOML parser: with a comment in one
// row that must give the same bits.
TEST(WorldFile, RowsAsTheyAreWrittenAreReadAsTheParserDoes) {
  const std::string text = long_text() + "[[segment]]\nsegment = [0, 0, 0, 1, 2, 3]\n";
  ASSERT_GT(text.size(), 1'000'000u);
  ASSERT_TRUE(take_written_rows(text));
  std::string commented = text;
  commented.insert(commented.find("],\n") + 2, "  # a row");
  ASSERT_FALSE(take_written_rows(commented));
  const WorldDescription fast = parse_world(text, "text"), slow = parse_world(commented, "text");
  EXPECT_EQ(fast.loose.segments_m, slow.loose.segments_m);
  EXPECT_EQ(fast.loose.surfaces_m, slow.loose.surfaces_m);
  EXPECT_EQ(fast.loose.corners_m, slow.loose.corners_m);
  EXPECT_EQ(fast.loose.segments_m.back().second, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(fast.route.size(), slow.route.size());
  EXPECT_EQ(format_world(fast), format_world(slow));
}

TEST(WorldFile, FaultsOfLongTextsHaveTheirLines) {
  const std::string text = long_text();
  const std::string row = "  [0, 0, 0, 0, 0, 0],\n";
  const std::size_t at = text.find("surfaces = [") - 2;
  const auto line = std::to_string(1 + std::count(text.begin(), text.begin() + at, '\n'));
  std::string zero = text;
  zero.insert(at, row);
  EXPECT_NE(message_of(zero).find(":" + line + ": loose segment"), std::string::npos)
      << message_of(zero);
  for (const char* odd :
       {"  [01, 0, 0, 0, 0, 1],\n", "  [1_0, 0, 0, 0, 0, 1],\n", "  [1e0, 0, 0, 0, 0, 1],\n",
        "  [+1, 0, 0, 0, 0, 1],\n", "  [.5, 0, 0, 0, 0, 1],\n", "  [1., 0, 0, 0, 0, 1],\n",
        "  [1, 0, 0, 0, 0],\n", "  [1, 0, 0, 0, 0, 1, 2],\n"}) {
    std::string changed = text;
    changed.insert(at, odd);
    EXPECT_FALSE(take_written_rows(changed)) << odd;
  }
  // What comes later in the file keeps its line too.
  const auto lines = std::to_string(1 + std::count(text.begin(), text.end(), '\n'));
  EXPECT_NE(message_of(text + "[[rute]]\n").find(":" + lines + ": unknown key"), std::string::npos);
  EXPECT_NE(message_of(text + "[loose]\n").find(":" + lines + ":"), std::string::npos);
}

class WorldFileFault : public testing::TestWithParam<Fault> {};

TEST_P(WorldFileFault, IsNamedWithFileLineAndRemedy) {
  EXPECT_EQ(message_of(kHead + GetParam().text), std::string("w.world.toml:") + GetParam().message);
}

const Fault kFaults[] = {
    {"[[instanse]]\n", "3: unknown key 'instanse'; did you mean 'instance'?"},
    {"nam = \"x\"\n", "3: unknown key 'nam'; did you mean 'name'?"},
    {"[[template]]\nname = \"a\"\nsegmens = []\n",
     "5: unknown key 'segmens' in [[template]]; did you mean 'segments'?"},
    {"[loose]\npolygons = []\n",
     "4: unknown key 'polygons' in [loose]; use 'segments', 'surfaces' or 'corners'"},
    {"[[template]]\nsegments = []\n", "3: template 0 has no 'name'; add it"},
    {"[[template]]\nname = \"\"\n", "4: template 0 has an empty name; add a name"},
    {"[[template]]\nname = 3\n", "4: template 0 name is not a string; put it in quotes"},
    {"[[template]]\nname = \"a\"\n[[template]]\nname = \"a\"\n",
     "5: template 'a' is already defined in line 3; rename one of the two"},
    {"[[template]]\nname = \"a\"\nsegments = [\n  [0, 0, 0, 1, 0, 0],\n  [1, 2, 3, 1, 2, 3],\n]\n",
     "7: template 'a' segment 1 has zero length; move one end or remove it"},
    {"[[segment]]\nsegment = [0, 0, 0, 0.0005, 0, 0]\n",
     "4: loose segment 0 is shorter than 1 mm; move one end or remove it"},
    {"[[segment]]\nsegment = [0, 0, 0, 1, 0]\n", "4: loose segment 0 has 5 numbers; it takes 6"},
    {"[[segment]]\nsegment = [0, 0, 0, 1, 0, true]\n",
     "4: loose segment 0 holds something that is not a number; write a number"},
    {"[loose]\nsegments = [\n[0, 0, 0, 1, 0, 0],\n[0, 0, 0, nan, 0, 0]]\n",
     "6: loose segment 1 holds a number that is not finite; write a finite number"},
    {"[[corner]]\nat_m = [0, -inf, 0]\n",
     "4: loose corner 0 holds a number that is not finite; write a finite number"},
    {"[[segment]]\n", "3: [[segment]] has no 'segment'; add it"},
    {"[segment]\n", "3: 'segment' is not a list of tables; write [[segment]]"},
    {"segment = [1, 2]\n", "3: [[segment]] is not a table; write it as a table of keys"},
    {"loose = 1\n", "3: [loose] is not a table; write it as a table of keys"},
    {"[loose]\nsegments = 1\n", "4: loose segments is not a list; write it as [ … ]"},
    {"[[surface]]\npolygon = [[0,0,0], [1,0,0], [1,1,0.1], [0,1,0]]\n",
     "4: loose surface 0 is not planar to 1 mm; split it into triangles"},
    {"[[surface]]\npolygon = [[0,0,0], [1,0,0]]\n",
     "4: loose surface 0 has fewer than three points; use at least three"},
    {"[[template]]\nname = \"door\"\n[[instance]]\ntemplate = \"dor\"\nat_m = [0,0,0]\n",
     "6: instance 0 refers to the unknown template 'dor'; did you mean 'door'?"},
    {"[[instance]]\ntemplate = \"dor\"\nat_m = [0,0,0]\n",
     "4: instance 0 refers to the unknown template 'dor'; define it in a [[template]]"},
    {"[[instance]]\ntemplate = \"dor\"\n", "3: instance 0 has no 'at_m'; add it"},
    {"[[route]]\npoints_m = [[0, 0]]\n", "4: route 0 has fewer than two points; use at least two"},
    {"[[route]]\npoints_m = [[0, 0], [1, 1, 1]]\n", "4: route 0 point has 3 numbers; it takes 2"},
};

INSTANTIATE_TEST_SUITE_P(All, WorldFileFault, testing::ValuesIn(kFaults));

TEST(WorldFile, NamesAMissingOrWrongHeader) {
  EXPECT_EQ(message_of(""),
            "w.world.toml:1: the file has no format; add format = \"vernier/world\"");
  EXPECT_EQ(message_of("format = \"vernier/rig\"\n"),
            "w.world.toml:1: the format is 'vernier/rig'; use a file of format "
            "vernier/world");
  EXPECT_EQ(message_of("format = \"vernier/world\"\n"),
            "w.world.toml:1: the file has no version; add version = 1");
  EXPECT_EQ(message_of("format = \"vernier/world\"\nversion = 2\n"),
            "w.world.toml:2: version 2 is not supported; supported: 1");
}

// A robot would stand above or below all of it, and see nothing.
TEST(WorldFile, FloorsAreAtZero) {
  const auto between = [](double low, double high) {
    WorldDescription world;
    world.loose.segments_m = {{{0, 0, low}, {0, 0, high}}};
    return world;
  };
  const auto fault = [&](double low, double high) {
    return message_of(format_world(between(low, high)));
  };
  EXPECT_EQ(fault(-5, -2.4),
            "w.world.toml: lies from -5 to -2.4 m, and the floor is at z = 0; shift it, so that "
            "robots stand on its floor");
  EXPECT_NE(fault(5, 7.6), "");
  for (const auto& [low, high] : {std::pair(-5.0, 0.0), {0.0, 30.0}, {3.9, 9.0}, {-3.0, 9.0}}) {
    EXPECT_NO_THROW(parse_world(format_world(between(low, high)), "w"));
  }
  WorldDescription of_template = between(5, 7);
  of_template.templates = {{"lamp", of_template.loose}};
  of_template.loose = {};
  of_template.instances = {{"lamp", {1, 1, -4}, 0}};
  EXPECT_NO_THROW(parse_world(format_world(of_template), "w"));
  of_template.instances[0].at_m.z() = 0;
  EXPECT_THROW(parse_world(format_world(of_template), "w"), Error);
}

TEST(WorldFile, NamesTheLineOfASyntaxError) {
  const std::string message = message_of(kHead + "name = \n");
  EXPECT_EQ(message.rfind("w.world.toml:3: not TOML: ", 0), 0u) << message;
  EXPECT_NE(message.find("; correct the syntax"), std::string::npos) << message;
}

TEST(WorldFile, ReadsTenThousandSegments) {
  WorldDescription world;
  for (int i = 0; i < 10000; ++i) {
    const double x = 0.0123 * i;
    world.loose.segments_m.push_back({{x, 1.2345, 0.5}, {x, 7.6543, 2.4321}});
  }
  const WorldDescription again = parse_world(format_world(world), "text");
  ASSERT_EQ(again.loose.segments_m.size(), world.loose.segments_m.size());
  for (std::size_t i = 0; i < again.loose.segments_m.size(); ++i) {
    const auto& [a, b] = world.loose.segments_m[i];
    const auto& [p, q] = again.loose.segments_m[i];
    EXPECT_LT((a - p).norm() + (b - q).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace vernier
