// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/mesh_file_message.h"
#include "tests/support/spiral_ply.h"

namespace vernier::sim::internal {
namespace {

using vernier::test::error_message;
using vernier::test::Folder;
using vernier::test::mesh_file_message;

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
    return mesh_file_message("a.ply", changed);
  };
  EXPECT_EQ(mesh_file_message("a.ply", "solid"), "a.ply: does not begin with ply; use a PLY file");
  EXPECT_EQ(mesh_file_message("a.ply", "ply\nformat ascii 1.0\n"),
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
  EXPECT_EQ(mesh_file_message("a.ply", nothing), "");
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
    EXPECT_NE(mesh_file_message("a.ply", text.substr(0, size)), "") << size;
  }
  const std::string binary = binary_square(false);
  for (std::size_t size = 0; size < binary.size(); ++size) {
    EXPECT_NE(mesh_file_message("a.ply", binary.substr(0, size)), "") << size;
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
  EXPECT_EQ(mesh_file_message("a.ply", text),
            "a.ply: has a face of 2001 corners, face 0; export it in triangles");
}

// Property: a face's triangles have its area, however many concave corners it has.
TEST(PlyFile, FacesOfManyConcaveCornersKeepTheirArea) {
  const Folder folder;
  const Mesh mesh = read_mesh(folder.write("s.ply", test::spiral_ply(2000)));
  ASSERT_EQ(mesh.triangles.size(), 1998u);
  double twice_turned = 0;
  const auto& at = mesh.vertices;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Eigen::Vector3d& next = at[(i + 1) % at.size()];
    twice_turned += at[i].x() * next.y() - at[i].y() * next.x();
  }
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area += 0.5 * (at[b] - at[a]).cross(at[c] - at[a]).norm();
  }
  EXPECT_NEAR(area, 0.5 * std::abs(twice_turned), 1e-6);
}

TEST(PlyFile, HasNoNamesOfParts) {
  const Folder folder;
  EXPECT_NE(error_message([&] {
              read_mesh(folder.write("a.ply", square), {{"door"}, 0});
            }).find("no names of parts"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::sim::internal
