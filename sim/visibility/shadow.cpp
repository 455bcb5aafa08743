// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/shadow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace vernier::sim::internal {
namespace {

constexpr double on_side_m = 1e-9;

/// Appends what is visible on one side: the complement in `whole` of the intervals hidden on that
/// side. `hidden` is sorted by t0.
void append_visible(const Stretch& whole,
                    const std::vector<OccludedInterval>& hidden,
                    int hand,
                    std::vector<Stretch>& visible) {
  double from = whole.t0;
  for (std::size_t i = 0; i < hidden.size() && hidden[i].t0 < whole.t1;) {
    if (!(hidden[i].hands & hand)) {
      ++i;
      continue;
    }
    const double t0 = hidden[i].t0;
    double t1 = hidden[i].t1;
    for (++i; i < hidden.size() && hidden[i].t0 <= t1 + touching; ++i) {
      if (hidden[i].hands & hand) t1 = std::max(t1, hidden[i].t1);
    }
    if (t1 - t0 <= touching) continue;  // a touch, not an occlusion
    if (t0 - from > min_stretch) visible.push_back({from, t0});
    from = std::max(from, t1);
  }
  if (whole.t1 - from > min_stretch) visible.push_back({from, whole.t1});
}

/// Union of two ascending lists: a point is visible if it is so on either side.
void unite(const std::vector<Stretch>& one,
           const std::vector<Stretch>& other,
           std::vector<Stretch>& united) {
  std::vector<Stretch> all(one.size() + other.size());
  std::merge(one.begin(), one.end(), other.begin(), other.end(), all.begin(),
             [](const Stretch& u, const Stretch& v) { return u.t0 < v.t0; });
  for (const Stretch& s : all) {
    if (!united.empty() && s.t0 <= united.back().t1 + touching) {
      united.back().t1 = std::max(united.back().t1, s.t1);
    } else {
      united.push_back(s);
    }
  }
}

}  // namespace

ShadowSide shadow_side(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const Eigen::Vector3d inward = p.cross(q);
  return {inward, inward.norm() * on_side_m};
}

OccludedInterval occluded_interval(const Shadow& shadow,
                                   const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b,
                                   double t0,
                                   double t1,
                                   double gap_m) {
  const double beyond_a = shadow.normal.dot(a) - shadow.distance_m - gap_m;
  const double beyond_b = shadow.normal.dot(b) - shadow.distance_m - gap_m;
  if (beyond_a <= 0 && beyond_b <= 0) return {};
  if (beyond_a < 0) t0 = std::max(t0, beyond_a / (beyond_a - beyond_b));
  if (beyond_b < 0) t1 = std::min(t1, beyond_a / (beyond_a - beyond_b));

  int hands = OccludedInterval::both;
  for (const ShadowSide& side : shadow.sides) {
    const double f_a = side.inward.dot(a), f_b = side.inward.dot(b);
    const bool a_in = f_a > side.tolerance, b_in = f_b > side.tolerance;
    if (a_in && b_in) continue;
    if (!a_in && !b_in) {
      if (f_a < -side.tolerance || f_b < -side.tolerance) return {};
      // The segment runs along this side: the shadow lies on one side of it only.
      hands &= side.inward.dot(a.cross(b)) > 0 ? OccludedInterval::left : OccludedInterval::right;
    } else if (a_in ? f_b < -side.tolerance : f_a < -side.tolerance) {
      const double t = f_a / (f_a - f_b);
      if (a_in) {
        t1 = std::min(t1, t);
      } else {
        t0 = std::max(t0, t);
      }
    }
    if (t0 >= t1) return {};
  }
  if (t0 >= t1) return {};
  return {t0, t1, hands};
}

PointInShadow point_in_shadow(const Shadow& shadow,
                              const Eigen::Vector3d& x,
                              double gap_m,
                              std::vector<Eigen::Vector3d>* touched) {
  if (shadow.normal.dot(x) - shadow.distance_m <= gap_m) return PointInShadow::outside;
  bool on_border = false;
  for (const ShadowSide& side : shadow.sides) {
    const double f = side.inward.dot(x);
    if (f < -side.tolerance) return PointInShadow::outside;
    on_border |= f <= side.tolerance;
  }
  if (!on_border) return PointInShadow::inside;
  for (const ShadowSide& side : shadow.sides) {
    if (touched && side.inward.dot(x) <= side.tolerance) touched->push_back(side.inward);
  }
  return PointInShadow::on_border;
}

std::vector<Eigen::Vector3d> points_around(const Eigen::Vector3d& x,
                                           const std::vector<Eigen::Vector3d>& touched) {
  const Eigen::Vector3d u = x.unitOrthogonal(), v = u.cross(x).normalized();
  std::vector<double> angles;
  for (const Eigen::Vector3d& inward : touched) {
    const double along = std::atan2(inward.dot(v), inward.dot(u)) + std::numbers::pi / 2;
    angles.push_back(std::remainder(along, 2 * std::numbers::pi));
    angles.push_back(std::remainder(along + std::numbers::pi, 2 * std::numbers::pi));
  }
  std::sort(angles.begin(), angles.end());
  angles.push_back(angles.front() + 2 * std::numbers::pi);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) {
    const double angle = 0.5 * (angles[i] + angles[i + 1]);
    points.push_back(x + 10 * on_side_m * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

ProjectedSegment::ProjectedSegment(const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b,
                                   const Stretch& s)
    : stretch(s) {
  const Eigen::Vector3d from = a + s.t0 * (b - a), to = a + s.t1 * (b - a);
  z0 = from.z();
  z1 = to.z();
  x0 = from.head<2>() / z0;
  x1 = to.head<2>() / z1;
}

void subtract_intervals(const Stretch& whole,
                        std::vector<OccludedInterval>& hidden,
                        std::vector<Stretch>& visible) {
  visible.clear();
  bool one_handed = false;
  for (const OccludedInterval& h : hidden) one_handed |= h.hands != OccludedInterval::both;
  std::sort(hidden.begin(), hidden.end(),
            [](const OccludedInterval& u, const OccludedInterval& v) { return u.t0 < v.t0; });
  if (!one_handed) return append_visible(whole, hidden, OccludedInterval::left, visible);
  std::vector<Stretch> left, right;
  append_visible(whole, hidden, OccludedInterval::left, left);
  append_visible(whole, hidden, OccludedInterval::right, right);
  unite(left, right, visible);
}

}  // namespace vernier::sim::internal
