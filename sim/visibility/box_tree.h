// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
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

  /// The same, in the order of the boxes' distances from a point.
  template <class Meets, class Visit>
  void visit_nearest(const Eigen::Vector3d& from, Meets meets, Visit visit) const {
    if (boxes_.empty()) return;
    // Least distance first; objects have negative numbers.
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    open.emplace(0, tree_.getRootIndex());
    if (boxes_.size() == 1) {
      if (meets(boxes_[0])) visit(0);
      return;
    }
    while (!open.empty()) {
      const int entry = open.top().second;
      open.pop();
      if (entry < 0) {
        const int i = -1 - entry;
        // What was met since may hide it.
        if (meets(boxes_[i]) && visit(i)) return;
        continue;
      }
      if (!meets(tree_.getVolume(entry))) continue;
      typename Tree::VolumeIterator volume = nullptr, last_volume = nullptr;
      typename Tree::ObjectIterator object = nullptr, last_object = nullptr;
      tree_.getChildren(entry, volume, last_volume, object, last_object);
      for (; volume != last_volume; ++volume) {
        open.emplace(tree_.getVolume(*volume).squaredExteriorDistance(from), *volume);
      }
      for (; object != last_object; ++object) {
        open.emplace(boxes_[*object].squaredExteriorDistance(from), -1 - *object);
      }
    }
  }

 private:
  using Tree = Eigen::KdBVH<double, 3, int>;

  template <class Meets, class Visit>
  struct Query {
    const std::vector<Eigen::AlignedBox3d>& boxes;
    Meets& meets;
    Visit& visit;

    bool intersectVolume(const Eigen::AlignedBox3d& box) { return meets(box); }
    bool intersectObject(int i) { return meets(boxes[i]) && visit(i); }
  };

  std::vector<Eigen::AlignedBox3d> boxes_;
  Tree tree_;
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
