// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <unsupported/Eigen/BVH>
#include <utility>
#include <vector>

namespace vernier::sim::internal {

/// Boxes by place, in a binary tree: finds those that meet a region in about the logarithm of all,
/// in memory that depends on their number and not on their extent.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Eigen::AlignedBox3d> boxes) : boxes_(std::move(boxes)) {
    std::vector<int> numbers(boxes_.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    tree_.init(numbers.begin(), numbers.end(), boxes_.begin(), boxes_.end());
  }

  /// Calls visit(i) for every box i that `meets`, in no particular order, until it returns true.
  /// `meets` is called for boxes around several ones too.
  template <class Meets, class Visit>
  void visit(Meets meets, Visit visit) const {
    Query<Meets, Visit> query{boxes_, meets, visit};
    Eigen::BVIntersect(tree_, query);
  }

  /// The boxes that `meets`, ascending.
  template <class Meets>
  void find(Meets meets, std::vector<int>& found) const {
    found.clear();
    visit(meets, [&](int i) {
      found.push_back(i);
      return false;
    });
    std::sort(found.begin(), found.end());
  }

 private:
  template <class Meets, class Visit>
  struct Query {
    const std::vector<Eigen::AlignedBox3d>& boxes;
    Meets& meets;
    Visit& visit;

    bool intersectVolume(const Eigen::AlignedBox3d& box) { return meets(box); }
    bool intersectObject(int i) { return meets(boxes[i]) && visit(i); }
  };

  std::vector<Eigen::AlignedBox3d> boxes_;
  Eigen::KdBVH<double, 3, int> tree_;
};

/// Whether a segment meets a box.
inline bool meets_box(const Eigen::AlignedBox3d& box,
                      const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b) {
  double t0 = 0, t1 = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min()[axis] - a[axis], high = box.max()[axis] - a[axis];
    const double d = b[axis] - a[axis];
    if (d == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    t0 = std::max(t0, std::min(low / d, high / d));
    t1 = std::min(t1, std::max(low / d, high / d));
  }
  return t0 <= t1;
}

}  // namespace vernier::sim::internal
