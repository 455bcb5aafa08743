// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/mesh_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
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
#include "sim/mesh_files/mesh_bytes.h"
#include "sim/world.h"
#include "sim/world/world_export.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/mesh_file_message.h"

namespace vernier::sim::internal {
namespace {

using vernier::test::error_message;
using vernier::test::Folder;
using vernier::test::mesh_file_message;

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
  EXPECT_EQ(mesh_file_message("a.txt", "0 0 0 1 0 0\n0 0 0 1 0\n"),
            "a.txt:2: has 5 numbers; give x1 y1 z1 x2 y2 z2, in metres");
  EXPECT_EQ(mesh_file_message("a.txt", "0 0 0 1 0 0 7\n"),
            "a.txt:1: has 7 numbers; give x1 y1 z1 x2 y2 z2, in metres");
  EXPECT_NE(mesh_file_message("a.txt", "0 0 0 1 0 one\n").find("a.txt:1:"), std::string::npos);
}

TEST(MeshFile, RefusesWhatItCannotRead) {
  const Folder folder;
  EXPECT_NE(error_message([&] { read_mesh(folder.path() / "no.obj"); }).find("no such file"),
            std::string::npos);
  EXPECT_NE(error_message([&] { read_mesh(folder.path()); }).find("holds no track_N.txt"),
            std::string::npos);
  EXPECT_NE(mesh_file_message("a.docx", "text"), "");
  if (assimp_version().empty()) GTEST_SKIP() << "built without assimp";
  EXPECT_EQ(mesh_file_message("a.ifc", "ISO-10303-21;\nHEADER;\n"),
            "a.ifc: is cut short: no line END-ISO-10303-21 ends it; copy or export it again");
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

// What a child tells is checked: a library may have damaged the memory that it is told from.
TEST(ChildProcess, TellsBytesOrAnError) {
  const auto said = [](const std::string& told) {
    return error_message([&] { child_result(told, "a.ifc"); });
  };
  const std::string damaged =
      "a.ifc: is damaged, or of a kind on which its reader fails; check the file, or convert it to "
      "another format";
  const std::string none(1, '\0');
  EXPECT_EQ(child_result("Gbytes", "a.ifc"), "bytes");
  EXPECT_EQ(said("R" + none + "is wrong" + none + "mend it"), "a.ifc: is wrong; mend it");
  EXPECT_EQ(said(""), damaged);
  EXPECT_EQ(said("R"), damaged);
  EXPECT_EQ(said("Rplace" + none + "is wrong"), damaged);
  EXPECT_EQ(said("R" + none + none), damaged);
  EXPECT_EQ(said("Xbytes"), damaged);
}

TEST(MeshBytes, ComeBackOrAreRefused) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 0, 2.5}};
  mesh.triangles = {{0, 1, 2}};
  mesh.lines = {{0, 2}};
  mesh.up_axis = 1;
  mesh.unit_m = 0.001;
  mesh.parts_left_out = 3;
  const std::string bytes = mesh_bytes(mesh);
  const Mesh again = mesh_of_bytes(bytes, "a.ifc");
  EXPECT_EQ(again.vertices, mesh.vertices);
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.lines, mesh.lines);
  EXPECT_EQ(again.up_axis, 1);
  EXPECT_EQ(again.unit_m, 0.001);
  EXPECT_EQ(again.parts_left_out, 3u);

  const auto said = [](const std::string& told) {
    return error_message([&] { mesh_of_bytes(told, "a.ifc"); });
  };
  const std::string cut = "a.ifc: was not read to its end; run it again where there is more memory";
  EXPECT_EQ(said(""), cut);
  EXPECT_EQ(said(bytes.substr(1)), cut);
  EXPECT_EQ(said(std::string(40, '\xff') + bytes.substr(40)), cut);  // counts that no file has
  mesh.lines = {{0, 3}};
  EXPECT_NE(said(mesh_bytes(mesh)).find("is damaged"), std::string::npos);
  mesh.lines.clear();
  mesh.up_axis = 3;
  EXPECT_NE(said(mesh_bytes(mesh)).find("is damaged"), std::string::npos);
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
