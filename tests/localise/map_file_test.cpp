// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::localise;

namespace {

using test::error_message;
using test::Folder;

TopologicalMap some_rooms(int nodes, int lines = 20) {
  TopologicalMap map;
  for (int i = 0; i < nodes; ++i) {
    MapNode node{{0.5 * i, -1.25, 0.1 * i}, test::view_of(test::random_room(i, lines), 0.1)};
    for (int k = 0; k < 3; ++k) node.view.image_lines.push_back({{1.5 * k, 2}, {3, 4.25 + i}});
    map.nodes.push_back(node);
  }
  return map;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_same(const TopologicalMap& a, const TopologicalMap& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const MapNode &p = a.nodes[i], &q = b.nodes[i];
    EXPECT_EQ(p.pose.x_m, q.pose.x_m);
    EXPECT_EQ(p.pose.heading_rad, q.pose.heading_rad);
    EXPECT_EQ(p.view.mount.pitch_rad, q.view.mount.pitch_rad);
    // A rig.json holds rotations as quaternions.
    EXPECT_LT((parameters(*p.view.rig) - parameters(*q.view.rig)).cwiseAbs().maxCoeff(), 1e-12);
    ASSERT_EQ(p.view.lines.size(), q.view.lines.size());
    for (std::size_t k = 0; k < p.view.lines.size(); ++k) {
      EXPECT_EQ(p.view.lines[k].a_m, q.view.lines[k].a_m);
      EXPECT_EQ(p.view.lines[k].b_m, q.view.lines[k].b_m);
      EXPECT_EQ(p.view.lines[k].kind, q.view.lines[k].kind);
      EXPECT_EQ(p.view.lines[k].sigma_m, q.view.lines[k].sigma_m);
    }
    ASSERT_EQ(p.view.image_lines.size(), q.view.image_lines.size());
    for (std::size_t k = 0; k < p.view.image_lines.size(); ++k) {
      EXPECT_EQ(p.view.image_lines[k].a_px, q.view.image_lines[k].a_px);
      EXPECT_EQ(p.view.image_lines[k].b_px, q.view.image_lines[k].b_px);
    }
    ASSERT_EQ(p.view.corners.size(), q.view.corners.size());
    for (std::size_t k = 0; k < p.view.corners.size(); ++k) {
      EXPECT_EQ(p.view.corners[k].left_px, q.view.corners[k].left_px);
      EXPECT_EQ(p.view.corners[k].right_px, q.view.corners[k].right_px);
      EXPECT_EQ(p.view.corners[k].covariance_px2, q.view.corners[k].covariance_px2);
      EXPECT_EQ(p.view.corners[k].descriptor, q.view.corners[k].descriptor);
    }
  }
}

StereoCorner some_corner(int i, int descriptor) {
  StereoCorner corner;
  corner.left_px = {100.25 + i, 50.5};
  corner.right_px = {90 + i / 3.0, 50};
  corner.covariance_px2 = 0.1 * Eigen::Matrix4d::Identity();
  corner.covariance_px2(0, 2) = corner.covariance_px2(2, 0) = 0.01 * i;
  corner.descriptor = Eigen::VectorXf::LinSpaced(descriptor, -0.3f, 0.7f);
  return corner;
}

/// Rooms whose second node has corners, and every third one after it.
TopologicalMap rooms_with_corners(int nodes, int descriptor) {
  TopologicalMap map = some_rooms(nodes, 2);
  for (int i = 1; i < nodes; i += 3) {
    for (int k = 0; k < 4; ++k) map.nodes[i].view.corners.push_back(some_corner(k, descriptor));
  }
  return map;
}

TEST(MapFile, KeepsCorners) {
  const Folder folder;
  const auto file = folder.path() / "a.map", bare = folder.path() / "b.map";
  for (const int descriptor : {0, 5, 32}) {
    for (const int nodes : {2, 9, 1003}) {
      TopologicalMap map = rooms_with_corners(nodes, descriptor);
      write_map(file, map);
      EXPECT_EQ(bytes_of(file)[8], 2);
      expect_same(map, read_map(file));
      extend_map(file, map.nodes);
      const auto once = map.nodes;
      map.nodes.insert(map.nodes.end(), once.begin(), once.end());
      expect_same(map, read_map(file));
    }
  }
  // A map without corners is of version 1, until a node with some is added.
  TopologicalMap map = some_rooms(3, 2);
  write_map(bare, map);
  EXPECT_EQ(bytes_of(bare)[8], 1);
  const TopologicalMap more = rooms_with_corners(2, 8);
  extend_map(bare, more.nodes);
  EXPECT_EQ(bytes_of(bare)[8], 2);
  map.nodes.insert(map.nodes.end(), more.nodes.begin(), more.nodes.end());
  expect_same(map, read_map(bare));
}

/// What docs/file-formats.md states: 112 bytes a corner and 4 for each entry of its descriptor.
TEST(MapFile, ACornerCostsWhatIsStated) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  TopologicalMap map = some_rooms(1, 2);
  std::size_t before = 0;
  for (const int corners : {50, 150}) {
    map.nodes[0].view.corners.assign(corners, some_corner(1, 32));
    write_map(file, map);
    const std::size_t bytes = bytes_of(file).size();
    if (before > 0) {
      EXPECT_EQ(bytes - before, 100u * (112 + 4 * 32));
    }
    before = bytes;
  }
}

TEST(MapFile, RefusesCornersThatAreNone) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  for (const int fault : {0, 1, 2}) {
    TopologicalMap wrong = rooms_with_corners(2, 8);
    StereoCorner& corner = wrong.nodes[1].view.corners[1];
    if (fault == 0) corner.left_px.x() = std::numeric_limits<double>::quiet_NaN();
    if (fault == 1) corner.covariance_px2.setZero();
    if (fault == 2) corner.descriptor.resize(7);
    EXPECT_NE(error_message([&] { write_map(file, wrong); }).find("map node 1: holds a corner"),
              std::string::npos)
        << fault;
  }
  write_map(file, rooms_with_corners(2, 8));
  const std::string good = bytes_of(file);
  for (std::size_t at = 0; at < good.size(); at += 3) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ 16);
    const auto damaged = folder.write("flipped.map", flipped);
    const std::string said = error_message([&] { read_map(damaged); });
    if (said.empty()) expect_same(read_map(file), read_map(damaged));  // a byte that fills up
  }
  for (std::size_t length = 0; length < good.size(); length += 5) {
    const auto cut = folder.write("cut.map", good.substr(0, length));
    ASSERT_NE(error_message([&] { read_map(cut); }), "") << length;
  }
}

TEST(MapFile, ReadsWhatWasWritten) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  for (const int nodes : {0, 1, 7, 1001}) {
    const TopologicalMap map = some_rooms(nodes, 4);
    write_map(file, map);
    expect_same(map, read_map(file));
    const std::string once = bytes_of(file);
    write_map(file, read_map(file));
    EXPECT_EQ(bytes_of(file).size(), once.size());
  }
  EXPECT_LT(bytes_of(file).size(), 1001u * 450);  // the rig once
}

TEST(MapFile, ExtendingGivesWhatWritingAllGives) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  TopologicalMap map = some_rooms(5);
  const TopologicalMap more = some_rooms(9);
  write_map(file, map);
  const std::string before = bytes_of(file);
  extend_map(file, more.nodes);
  EXPECT_EQ(bytes_of(file).substr(16, before.size() - 16), before.substr(16));
  map.nodes.insert(map.nodes.end(), more.nodes.begin(), more.nodes.end());
  expect_same(map, read_map(file));
  // Another mount or rig is stored with its nodes.
  TopologicalMap tilted = some_rooms(2);
  tilted.nodes[1].view.mount.pitch_rad = -0.2;
  extend_map(file, tilted.nodes);
  map.nodes.insert(map.nodes.end(), tilted.nodes.begin(), tilted.nodes.end());
  expect_same(map, read_map(file));
  TopologicalMap other = some_rooms(2);
  Rig rig = *other.nodes[0].view.rig;
  rig.T_camera_first[1].t.x() -= 0.01;
  for (MapNode& node : other.nodes) node.view.rig = std::make_shared<const Rig>(rig);
  extend_map(file, other.nodes);
  map.nodes.insert(map.nodes.end(), other.nodes.begin(), other.nodes.end());
  expect_same(map, read_map(file));
}

TEST(MapFile, KeepsWhatSeveralAddAtOnce) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  const TopologicalMap map = some_rooms(3);
  write_map(file, map);
  constexpr std::size_t writers = 6, turns = 10;
  const auto add = [&]() noexcept {
    for (std::size_t k = 0; k < turns; ++k) extend_map(file, map.nodes);
  };
  std::vector<pid_t> processes;
  for (std::size_t i = 0; i < writers; ++i) {
    const pid_t process = ::fork();
    if (process == 0) {
      add();
      ::_exit(0);
    }
    processes.push_back(process);
  }
  for (const pid_t process : processes) {
    int status = 0;
    ASSERT_EQ(::waitpid(process, &status, 0), process);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(read_map(file).nodes.size(), map.nodes.size() * (1 + writers * turns));
}

TEST(MapFile, CutsAndFlippedBitsAreRefused) {
  const Folder folder;
  const auto file = folder.path() / "a.map";
  write_map(file, some_rooms(3, 2));
  const std::string good = bytes_of(file);
  for (std::size_t length = 0; length < good.size(); length += 5) {
    const auto cut = folder.write("cut.map", good.substr(0, length));
    ASSERT_NE(error_message([&] { read_map(cut); }), "") << length;
  }
  for (std::size_t at = 0; at < good.size(); at += 3) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    const auto damaged = folder.write("flipped.map", flipped);
    const std::string said = error_message([&] { read_map(damaged); });
    if (said.empty()) {
      // A byte that fills a part up to 8 holds nothing.
      expect_same(read_map(file), read_map(damaged));
      continue;
    }
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_NE(said.find("flipped.map"), std::string::npos) << said;
  }
}

TEST(MapFile, SaysWhatIsWrong) {
  const Folder folder;
  const auto said_of = [&](const std::string& bytes) {
    const auto file = folder.write("a.map", bytes);
    return error_message([&] { read_map(file); }).substr(file.string().size());
  };
  const auto file = folder.path() / "good.map";
  write_map(file, some_rooms(2));
  std::string bytes = bytes_of(file);
  EXPECT_EQ(said_of("{}"), ": is not a map; make one with vernier map make or write_map()");
  bytes[8] = 3;
  EXPECT_EQ(said_of(bytes),
            ": is a map of version 3; this program reads versions 1 and 2: make the map again");
  bytes[8] = 1;
  EXPECT_EQ(said_of(bytes.substr(0, bytes.size() - 8)),
            ": is damaged: it is cut off; make the map again");
  bytes[12] = 3;
  EXPECT_EQ(said_of(bytes),
            ": is damaged: it has another number of nodes than its head says; make "
            "the map again");
  EXPECT_NE(error_message([&] { read_map(folder.path()); }).find("is a folder"), std::string::npos);
  EXPECT_NE(error_message([&] { read_map(folder.path() / "none"); }).find("is no file"),
            std::string::npos);

  TopologicalMap wrong = some_rooms(2);
  wrong.nodes[1].view.lines[0].a_m.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_message([&] { write_map(file, wrong); }).find("map node 1: holds a number"),
            std::string::npos);
  wrong = some_rooms(1);
  wrong.nodes[0].view.mount.height_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_message([&] { write_map(file, wrong); }).find("map node 0: holds a number"),
            std::string::npos);
  wrong = some_rooms(1);
  wrong.nodes[0].view.rig = nullptr;
  EXPECT_EQ(error_message([&] { write_map(file, wrong); }),
            "map: a node has no rig; set PlaceView::rig");
  expect_same(read_map(file), some_rooms(2));  // the old one stays
}

}  // namespace
}  // namespace vernier
