// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace vernier {

using namespace vernier::sim::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::vector<AlignedBox3d> random_boxes(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> place(-10, 10), size(0, 2);
  std::vector<AlignedBox3d> boxes;
  for (int i = 0; i < count; ++i) {
    const Vector3d low{place(random), place(random), place(random)};
    boxes.emplace_back(low, low + Vector3d{size(random), size(random), size(random)});
  }
  return boxes;
}

TEST(BoxTree, FindsWhatALoopFinds) {
  std::mt19937 random(1);
  for (const int count : {0, 1, 2, 3, 7, 500}) {
    const std::vector<AlignedBox3d> boxes = random_boxes(count, random);
    const BoxTree tree(boxes);
    for (const AlignedBox3d& region : random_boxes(50, random)) {
      const auto meets = [&](const AlignedBox3d& box) { return region.intersects(box); };
      std::vector<int> found, expected;
      tree.find(meets, found);
      for (int i = 0; i < count; ++i) {
        if (meets(boxes[i])) expected.push_back(i);
      }
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(BoxTree, StopsWhenTheVisitorSaysSo) {
  std::mt19937 random(2);
  const BoxTree tree(random_boxes(100, random));
  int visited = 0;
  tree.visit([](const AlignedBox3d&) { return true; }, [&](int) { return ++visited == 3; });
  EXPECT_EQ(visited, 3);
}

TEST(BoxTree, VisitsTheNearestFirst) {
  std::mt19937 random(4);
  for (const int count : {0, 1, 2, 3, 7, 500}) {
    const std::vector<AlignedBox3d> boxes = random_boxes(count, random);
    const BoxTree tree(boxes);
    for (const AlignedBox3d& region : random_boxes(20, random)) {
      const Vector3d from = region.max();
      const auto meets = [&](const AlignedBox3d& box) { return box.max().x() > region.min().x(); };
      std::vector<int> visited;
      double last = 0;
      tree.visit_nearest(from, meets, [&](int i) {
        EXPECT_GE(boxes[i].squaredExteriorDistance(from), last);
        last = boxes[i].squaredExteriorDistance(from);
        visited.push_back(i);
        return false;
      });
      std::sort(visited.begin(), visited.end());
      std::vector<int> expected;
      tree.find(meets, expected);
      EXPECT_EQ(visited, expected);
    }
  }
}

TEST(BoxTree, BoxesAllInOnePlaceAreNoDepth) {
  const BoxTree tree(std::vector<AlignedBox3d>(100'000, AlignedBox3d(Vector3d(1, 2, 3))));
  std::vector<int> found;
  tree.find([](const AlignedBox3d&) { return true; }, found);
  EXPECT_EQ(found.size(), 100'000u);
}

TEST(MeetsBox, AgreesWithPointsAlongTheSegment) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-3, 5);
  const AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(2, 1, 1.5));
  for (int k = 0; k < 500; ++k) {
    Vector3d a{place(random), place(random), place(random)};
    Vector3d b{place(random), place(random), place(random)};
    if (k % 5 == 0) b[k % 3] = a[k % 3];  // along a plane of the axes
    bool inside = false;
    for (int i = 0; i <= 1000 && !inside; ++i)
      inside = box.contains(Vector3d(a + 1e-3 * i * (b - a)));
    if (inside) {
      EXPECT_TRUE(meets_box(box, a, b));
    }
    AlignedBox3d wider(box.min() - Vector3d::Constant(0.02), box.max() + Vector3d::Constant(0.02));
    if (meets_box(box, a, b)) {
      bool near = false;
      for (int i = 0; i <= 1000 && !near; ++i)
        near = wider.contains(Vector3d(a + 1e-3 * i * (b - a)));
      EXPECT_TRUE(near);
    }
  }
}

}  // namespace
}  // namespace vernier
