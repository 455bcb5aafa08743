// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/mesh_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/error.h"
#include "datasets/shipped.h"
#include "sim/buildings/office.h"
#include "sim/import/imported_world.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/child_process.h"
#include "sim/mesh_files/ifc_unit.h"
#include "sim/world.h"
#include "sim/world/world_export.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier::sim::internal {
namespace {

using vernier::test::error_message;
using vernier::test::Folder;

std::string said_of(const std::string& name, const std::string& text) {
  const Folder folder;
  const std::filesystem::path file = folder.write(name, text);
  std::string said = error_message([&] { read_mesh(file); });
  const std::string path = folder.path().string() + "/";
  if (const std::size_t at = said.find(path); at != std::string::npos) said.erase(at, path.size());
  return said;
}

constexpr const char* square =
    "ply\nformat ascii 1.0\ncomment made\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 1\n"
    "property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\n"
    "property int vertex2\nend_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n1 3\n";

/// The square in binary.
std::string binary_square(bool is_big) {
  std::string text = square;
  text = text.substr(0, text.find("end_header") + 11);
  text.replace(text.find("ascii"), 5, is_big ? "binary_big_endian" : "binary_little_endian");
  const auto add = [&](auto value) {
    std::string bytes(sizeof value, 0);
    std::memcpy(bytes.data(), &value, sizeof value);
    if (is_big == (std::endian::native == std::endian::little)) {
      bytes = std::string(bytes.rbegin(), bytes.rend());
    }
    text += bytes;
  };
  for (const auto& [x, y] : {std::pair(0.f, 0.f), {1.f, 0.f}, {1.f, 1.f}, {0.f, 1.f}}) {
    add(x);
    add(y);
    add(0.f);
    add(std::uint8_t{9});
  }
  add(std::uint8_t{4});
  for (const std::int32_t i : {0, 1, 2, 3, 1, 3}) add(i);
  return text;
}

TEST(PlyFile, IsReadInAllItsEncodings) {
  const Folder folder;
  for (const std::string& text : {std::string(square), binary_square(false), binary_square(true)}) {
    const Mesh mesh = read_mesh(folder.write("a.PLY", text));
    ASSERT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(1, 1, 0));
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
    ASSERT_EQ(mesh.lines.size(), 1u);
    EXPECT_EQ(mesh.lines[0], (std::array<std::uint32_t, 2>{1, 3}));
  }
}

TEST(PlyFile, SaysWhatIsWrong) {
  const std::string text = square;
  const auto with = [&](const std::string& was, const std::string& is) {
    std::string changed = text;
    changed.replace(changed.find(was), was.size(), is);
    return said_of("a.ply", changed);
  };
  EXPECT_EQ(said_of("a.ply", "solid"), "a.ply: does not begin with ply; use a PLY file");
  EXPECT_EQ(said_of("a.ply", "ply\nformat ascii 1.0\n"),
            "a.ply: has no header that ends with end_header; use a PLY file");
  EXPECT_EQ(with("format ascii 1.0", "comment"),
            "a.ply: does not say its format; correct its header");
  EXPECT_EQ(with("ascii", "latin"),
            "a.ply: has an unknown format; use ascii or binary_little_endian");
  EXPECT_EQ(with("vertex 4", "vertex -4"),
            "a.ply: has a number of elements that is none; correct its header");
  EXPECT_EQ(with("vertex 4", "vertex 99999999999"),
            "a.ply: has 99999999999 of element vertex; export fewer details");
  EXPECT_EQ(with("float x", "flaot x"),
            "a.ply: has a property that is not understood; correct its header");
  EXPECT_EQ(with("property float x", "property"),
            "a.ply: has a property that is not understood; correct its header");
  EXPECT_EQ(with("property float z", "property float w"),
            "a.ply: has vertices without x, y and z; export it again");
  EXPECT_EQ(with("vertex 4", "vertex 4000"), "a.ply: ends too early; copy or export it again");
  std::string nothing = text;
  for (int i = 0; i < 3000; ++i) nothing.insert(nothing.find("end_header"), "element e 12000000\n");
  EXPECT_EQ(said_of("a.ply", nothing), "");
  EXPECT_EQ(with("4 0 1 2 3", "4 0 1 2 7"),
            "a.ply:19: face 0 names vertex 7, and there are 4; export it again");
  EXPECT_EQ(with("4 0 1 2 3", "4 0 1 2 -1"),
            "a.ply:19: face 0 names vertex -1, and there are 4; export it again");
  EXPECT_EQ(with("\n1 3\n", "\n1 4\n"),
            "a.ply:20: edge 0 names vertex 4, and there are 4; export it again");
  EXPECT_EQ(with("4 0 1 2 3", "4 0 1 2.7 3"),
            "a.ply:19: face 0 names vertex 2.7, which is no whole number; export it again");
  EXPECT_EQ(with("4 0 1 2 3", "3.5 0 1 2 3"),
            "a.ply:19: face 0 has a list whose count is no whole number; export it again");
  EXPECT_EQ(with("4 0 1 2 3", "-1 0 1 2 3"),
            "a.ply:19: face 0 has a list whose count is negative; export it again");
  EXPECT_EQ(with("\n1 3\n", "\n1 2.5\n"),
            "a.ply:20: edge 0 names vertex 2.5, which is no whole number; export it again");
  EXPECT_EQ(with("1 1 0 9", "1 nan 0 9"),
            "a.ply: vertex 2 is not finite; correct it, or export again");
  EXPECT_EQ(with("1 1 0 9", "1 one 0 9"),
            "a.ply:17: vertex 2 has a word where a number belongs; export it again");
  // Cut anywhere it is refused, or nothing of its content is missing.
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    EXPECT_NE(said_of("a.ply", text.substr(0, size)), "") << size;
  }
  const std::string binary = binary_square(false);
  for (std::size_t size = 0; size < binary.size(); ++size) {
    EXPECT_NE(said_of("a.ply", binary.substr(0, size)), "") << size;
  }
}

/// A wall of 8 x 3 m with a doorway from 3 to 4 m, 2 m high, as one face that begins at any corner;
/// a keyhole polygon is the same wall around a window, cut to its border.
std::string wall_of_one_face(int first, bool is_keyhole) {
  std::vector<std::string> corners{"0 0 0", "3 0 0", "3 0 2", "4 0 2",
                                   "4 0 0", "8 0 0", "8 0 3", "0 0 3"};
  std::vector<int> face{0, 1, 2, 3, 4, 5, 6, 7};
  if (is_keyhole) {
    corners = {"0 0 0", "8 0 0", "8 0 3", "0 0 3", "3 0 0.5", "3 0 2", "4 0 2", "4 0 0.5"};
    face = {0, 1, 2, 3, 0, 4, 5, 6, 7, 4};
  }
  std::rotate(face.begin(), face.begin() + first, face.end());
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const std::string& corner : corners) text += corner + "\n";
  text += std::to_string(face.size());
  for (const int corner : face) text += " " + std::to_string(corner);
  return text + "\n";
}

// Property: a face's triangles have its area, and none of them lies in its doorway or window.
TEST(PlyFile, ConcaveFacesKeepTheirOpenings) {
  const Folder folder;
  for (const bool is_keyhole : {false, true}) {
    for (int first = 0; first < (is_keyhole ? 10 : 8); ++first) {
      const Mesh mesh = read_mesh(folder.write("w.ply", wall_of_one_face(first, is_keyhole)));
      double area = 0;
      for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
        area += 0.5 * (q - p).cross(r - p).norm();
        const Eigen::Vector3d middle = (p + q + r) / 3;
        EXPECT_FALSE(middle.x() > 3 && middle.x() < 4 && middle.z() > 0.5 && middle.z() < 2);
      }
      EXPECT_NEAR(area, is_keyhole ? 24 - 1.5 : 24 - 2, 1e-9) << first;
    }
  }
}

// A float holds 500 km to 3 cm; ASCII has the digits that it shows.
TEST(PlyFile, SaysToWhatItsFloatsAreRounded) {
  const Folder folder;
  std::string far = binary_square(false);
  const float x = 500'000;
  std::memcpy(far.data() + far.find("end_header") + 11, &x, sizeof x);
  EXPECT_NEAR(read_mesh(folder.write("far.ply", far)).step, 0.06, 0.01);
  EXPECT_LT(read_mesh(folder.write("near.ply", binary_square(true))).step, 2e-7);
  std::string text = square;
  text.replace(text.find("0 0 0 9"), 7, "500000.123 0 0 9");
  EXPECT_EQ(read_mesh(folder.write("text.ply", text)).step, 0);
  const auto at = text.find("4 0 1 2 3");
  std::string corners = "2001";
  for (int i = 0; i < 2001; ++i) corners += " " + std::to_string(i % 4);
  text.replace(at, 9, corners);
  text.replace(text.find("uchar int vertex_indices"), 5, "int");
  EXPECT_EQ(said_of("a.ply", text),
            "a.ply: has a face of 2001 corners, face 0; export it in triangles");
}

/// Spirals of two arms, 2,000 corners each, as one face each.
std::string spirals(int count) {
  constexpr int corners = 2000;
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 2000\nproperty float x\n"
      "property float y\nproperty float z\nelement face " +
      std::to_string(count) + "\nproperty list int int vertex_indices\nend_header\n";
  for (int i = 0; i < corners; ++i) {
    const bool is_back = i >= corners / 2;
    const double turn = 0.05 * (is_back ? corners - 1 - i : i);
    const double radius = 1 + 0.1 * turn - (is_back ? 0.05 : 0);
    text += std::to_string(radius * std::cos(turn)) + " " +
            std::to_string(radius * std::sin(turn)) + " 0\n";
  }
  for (int face = 0; face < count; ++face) {
    text += std::to_string(corners);
    for (int i = 0; i < corners; ++i) text += " " + std::to_string(i);
    text += "\n";
  }
  return text;
}

// Cutting them into convex pieces takes the square of their corners, and took the cube.
TEST(PlyFile, ManyConcaveFacesAreReadWithinSeconds) {
  const Folder folder;
  const auto begin = std::clock();
  EXPECT_GT(read_mesh(folder.write("s.ply", spirals(4))).triangles.size(), 7900u);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 4);
}

TEST(IfcUnit, IsReadFromTheAssignment) {
  const std::string metre = "#1=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n";
  const std::string foot =
      "#2 = IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048), #1);\n#3=IFCDIMENSIONALEXPONENTS(1,0,0,"
      "0,0,0,0);\n#4=IFCCONVERSIONBASEDUNIT(#3,.LENGTHUNIT.,'FOOT;''s',#2);\n";
  const std::string others =
      "#8=IFCSIUNIT(*,.AREAUNIT.,$,.SQUARE_METRE.);\n/* #9=IFCUNITASSIGNMENT((#1)); */\n"
      "#5=IFCPROJECT('2x',$,'a;b',$,$,$,$,(#7),#6);\n";
  const auto metres = [&](const std::string& text) {
    return ifc_length_unit(text + others, "a.ifc").value_or(IfcLengthUnit{0, false}).metres;
  };
  EXPECT_EQ(metres(metre + "#6=IFCUNITASSIGNMENT((#8,#1));"), 1);
  EXPECT_EQ(metres("#1=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);#6=IFCUNITASSIGNMENT((#1));"),
            0.001);
  EXPECT_EQ(metres(metre + foot + "#6=IFCUNITASSIGNMENT((#8,#4));"), 0.3048);
  EXPECT_EQ(metres(metre + foot + "#6=IFCUNITASSIGNMENT((#8,/* (ft; */ #4 /*)*/)) /* ) */;"),
            0.3048);
  EXPECT_EQ(metres(metre + "#6=IFCUNITASSIGNMENT((#1,#8,#1));"), 1);  // listed twice
  // An inch by millimetres, and a yard by feet.
  EXPECT_NEAR(metres("#1=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);"
                     "#2=IFCMEASUREWITHUNIT(IFCRATIOMEASURE(25.4),#1);"
                     "#4=IFCCONVERSIONBASEDUNIT(#3,.LENGTHUNIT.,'INCH',#2);"
                     "#6=IFCUNITASSIGNMENT((#4));"),
              0.0254, 1e-12);
  EXPECT_NEAR(metres(metre + foot +
                     "#10=IFCMEASUREWITHUNIT(IFCRATIOMEASURE(3.),#4);"
                     "#11=IFCCONVERSIONBASEDUNIT(#3,.LENGTHUNIT.,'YARD',#10);"
                     "#6=IFCUNITASSIGNMENT((#11,#8));#12=IFCUNITASSIGNMENT((#1));"),
              0.9144, 1e-12);
  EXPECT_EQ(metres("#6=IFCUNITASSIGNMENT((#8));"), 0);
  EXPECT_EQ(metres(""), 0);
  const auto said = [&](const std::string& text) { return error_message([&] { metres(text); }); };
  EXPECT_EQ(said(metre + foot + "#6=IFCUNITASSIGNMENT((#1,#4));"),
            "a.ifc: assigns two units of length; leave one in its IFCUNITASSIGNMENT");
  EXPECT_NE(said("#4=IFCCONVERSIONBASEDUNIT(#3,.LENGTHUNIT.,'ELL',#99);"
                 "#6=IFCUNITASSIGNMENT((#4));")
                .find("has a unit of length that is not understood: #4"),
            std::string::npos);
  // One by itself.
  EXPECT_NE(said("#2=IFCMEASUREWITHUNIT(1.,#4);#4=IFCCONVERSIONBASEDUNIT(#3,.LENGTHUNIT.,'E',#2);"
                 "#6=IFCUNITASSIGNMENT((#4));")
                .find("not understood"),
            std::string::npos);
}

constexpr const char* two_parts =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no Wall\nusemtl plaster\nf 1 2 3\nusemtl Glass\n"
    "f 1 2 4\no Door_1\nusemtl plaster\nf 2 3 4\n";

// assimp calls the root of an OBJ file by the file's name.
TEST(MeshFile, PartsAreLeftOutByTheirNamesAndMaterialsButNotByTheFilesName) {
  if (assimp_version().empty()) GTEST_SKIP() << "built without assimp";
  const Folder folder;
  folder.write("m.mtl", "newmtl plaster\nnewmtl Glass\n");
  const auto file = folder.write("door_glass.obj", "mtllib m.mtl\n" + std::string(two_parts));
  EXPECT_EQ(read_mesh(file).triangles.size(), 3u);
  EXPECT_EQ(read_mesh(file, {{"door"}, 0}).triangles.size(), 2u);
  const Mesh mesh = read_mesh(file, {{"GLASS"}, 0});
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.parts_left_out, 1u);
  EXPECT_EQ(read_mesh(file, {{"glass", "Door"}, 0}).triangles.size(), 1u);
}

/// A tetrahedron whose faces look outwards, below a node that scales x.
std::string tetrahedron_below(const std::string& scale) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )"
         R"(version="1.4.1"><asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>)"
         R"(<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" )"
         R"(count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor )"
         R"(source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" )"
         R"(type="float"/><param name="Z" type="float"/></accessor></technique_common></source>)"
         R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles )"
         R"(count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3)"
         R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>)"
         R"(<visual_scene id="s"><node id="n"><matrix>)" +
         scale +
         R"( 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node>)"
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/>)"
         R"(</scene></COLLADA>)";
}

// Property: faces look outwards below a node that mirrors too.
TEST(MeshFile, FacesOfMirroredPartsLookOutwards) {
  if (assimp_version().empty()) GTEST_SKIP() << "built without assimp";
  const Folder folder;
  for (const char* scale : {"1", "-1", "-2"}) {
    const Mesh mesh = read_mesh(folder.write("m.dae", tetrahedron_below(scale)));
    ASSERT_EQ(mesh.triangles.size(), 4u);
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
    }
    EXPECT_NEAR(volume, std::abs(std::stod(scale)) / 6, 1e-6);
  }
}

TEST(LineList, IsReadAndSaysWhatIsWrong) {
  const Folder folder;
  const Mesh mesh =
      read_mesh(folder.write("a.lines.txt", "# floor\n0 0 0 1 0 0\n\n1,0,0,1,2,0\r\n"));
  EXPECT_EQ(mesh.lines.size(), 2u);
  EXPECT_EQ(mesh.unit_m, 1);
  EXPECT_EQ(mesh.up_axis, 2);
  EXPECT_EQ(said_of("a.txt", "0 0 0 1 0 0\n0 0 0 1 0\n"),
            "a.txt:2: has 5 numbers; give x1 y1 z1 x2 y2 z2, in metres");
  EXPECT_EQ(said_of("a.txt", "0 0 0 1 0 0 7\n"),
            "a.txt:1: has 7 numbers; give x1 y1 z1 x2 y2 z2, in metres");
  EXPECT_NE(said_of("a.txt", "0 0 0 1 0 one\n").find("a.txt:1:"), std::string::npos);
}

TEST(MeshFile, RefusesWhatItCannotRead) {
  const Folder folder;
  EXPECT_NE(error_message([&] { read_mesh(folder.path() / "no.obj"); }).find("no such file"),
            std::string::npos);
  EXPECT_NE(error_message([&] { read_mesh(folder.path()); }).find("holds no track_N.txt"),
            std::string::npos);
  EXPECT_NE(said_of("a.docx", "text"), "");
  EXPECT_NE(said_of("a.ifc", "ISO-10303-21;\nHEADER;\n"), "");
  EXPECT_NE(error_message([&] {
              read_mesh(folder.write("a.ply", square), {{"door"}, 0});
            }).find("no names of parts"),
            std::string::npos);
}

// What a library does to itself does not reach its caller.
TEST(ChildProcess, KeepsCrashesToItself) {
  const auto said = [](const std::function<std::string()>& work) {
    return error_message([&] { in_child_process(work, 1, "a.ifc"); });
  };
  EXPECT_EQ(in_child_process([] { return std::string(1'000'000, 'x'); }, 1, "a").size(),
            1'000'000u);
  EXPECT_EQ(in_child_process([] { return std::string(); }, 1, "a"), "");
  const std::string damaged =
      "a.ifc: is damaged, or of a kind on which its reader fails; check the file, or convert it to "
      "another format";
  EXPECT_EQ(said([]() -> std::string {
              ::raise(SIGSEGV);
              return "";
            }),
            damaged);
  EXPECT_EQ(said([]() -> std::string { ::_exit(0); }), damaged);
  EXPECT_EQ(said([]() -> std::string { throw Error("a.ifc:7", "is wrong", "mend it"); }),
            "a.ifc:7: is wrong; mend it");
  EXPECT_EQ(said([]() -> std::string { throw std::runtime_error("no"); }),
            "a.ifc: cannot be read: no; check the file, or convert it to another format");
  EXPECT_EQ(said([]() -> std::string {
              volatile bool go_on = true;
              while (go_on) {
              }
              return "";
            }),
            "a.ifc: was not read within 1 s of CPU time; check the file, or convert it to another "
            "format");
}

// Property: a world that is exported and imported again has the same edges, but for those shorter
// than what is asked for; pieces in a line are joined.
TEST(WorldExport, ComesBack) {
  const Folder folder;
  const World world = build_world(make_office(41));
  std::vector<std::pair<std::string, std::string>> files{{"o.ply", world_ply(world)}};
  if (!assimp_version().empty()) files.emplace_back("o.obj", world_obj(world));
  double length = 0, area_of_all = 0;
  for (const WorldSegment& s : world.segments) length += (s.b_m - s.a_m).norm();
  for (const auto& [name, text] : files) {
    ImportOptions options;
    options.shortest_m = 0.001;
    options.up_axis = 2;
    options.unit_m = 1;
    const ImportedWorld back = import_world(read_mesh(folder.write(name, text)), options, name);
    double again = 0;
    for (const auto& [a, b] : back.world.loose.segments_m) again += (b - a).norm();
    // Surfaces add the edges that a world leaves out, those of walls at the floor for instance.
    EXPECT_GT(again, 0.97 * length) << name;
    EXPECT_LT(again, 1.25 * length) << name;
    EXPECT_GT(back.world.loose.surfaces_m.size(), 0.5 * static_cast<double>(world.surfaces.size()));
    if (area_of_all == 0) area_of_all = again;
    EXPECT_NEAR(again, area_of_all, 0.01 * length) << "OBJ and PLY differ";
  }
}

}  // namespace
}  // namespace vernier::sim::internal
