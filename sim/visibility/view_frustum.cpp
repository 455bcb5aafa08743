// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility/view_frustum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "sim/visibility/shadow.h"

namespace vernier::sim::internal {
namespace {

constexpr int samples_a_side = 8;
constexpr double slack =
    0.01;  ///< of the image size; larger than the bend of a border between samples
constexpr int intervals = 8;  ///< of a segment, each bending in one direction only

/// Restricts [t0, t1] to where a linear function with these end values is not negative.
bool keep(double f_a, double f_b, Stretch& s) {
  if (f_a < 0) {
    if (f_b < 0) return false;
    s.t0 = std::max(s.t0, f_a / (f_a - f_b));
  } else if (f_b < 0) {
    s.t1 = std::min(s.t1, f_a / (f_a - f_b));
  }
  return s.t0 < s.t1;
}

/// A pixel coordinate of the distorted segment and its derivative by s.
struct Sample {
  Eigen::Vector2d pixel, slope;
};

/// Projection of a segment, x(s) = x_a + s (x_b - x_a) in normalised coordinates, distorted.
struct Curve {
  const Camera& camera;
  Eigen::Vector2d x_a, direction;

  Sample operator()(double s) const {
    const double* p = camera.parameters.data();
    const Eigen::Vector2d x = x_a + s * direction;
    const Eigen::Vector2d scale(p[0] * p[1], p[0]), centre(p[2], p[3]);
    return std::visit(
        [&](auto model) -> Sample {
          const auto d = model.distort(x, p + core_parameter_count);
          return {scale.cwiseProduct(d.x) + centre, scale.cwiseProduct(d.by_x * direction)};
        },
        camera.model);
  }
};

/// Distance of one pixel coordinate from one side of the image, positive inside.
struct Border {
  int axis;
  double sign, at;

  double value(const Sample& sample) const { return sign * (sample.pixel[axis] - at); }
  double slope(const Sample& sample) const { return sign * sample.slope[axis]; }
};

/// The root between s0 and s1, where the function changes sign: bracketed Newton iteration.
template <class Function>
double root(const Function& f, double s0, double s1, bool rising) {
  double s = 0.5 * (s0 + s1);
  for (int i = 0; i < 100 && s1 - s0 > 1e-16; ++i) {
    const auto [value, slope] = f(s);
    if (value == 0) return s;
    ((value < 0) == rising ? s0 : s1) = s;
    const double newton = s - value / slope;
    const double next = newton > s0 && newton < s1 ? newton : 0.5 * (s0 + s1);
    if (std::abs(next - s) < 1e-16) return next;
    s = next;
  }
  return s;
}

/// Where the slope of `border` vanishes between s0 and s1, by bisection: only its value there
/// matters, and that is flat.
double extremum(const Curve& curve, const Border& border, double s0, double s1, bool rising) {
  for (int i = 0; i < 40; ++i) {
    const double s = 0.5 * (s0 + s1);
    ((border.slope(curve(s)) < 0) == rising ? s0 : s1) = s;
  }
  return 0.5 * (s0 + s1);
}

/// Appends where the curve crosses `border` between two samples.
void append_crossings(const Curve& curve,
                      const Border& border,
                      double s0,
                      double s1,
                      const Sample& at0,
                      const Sample& at1,
                      std::vector<double>& cuts) {
  const double f0 = border.value(at0), f1 = border.value(at1);
  const auto f = [&](double s) {
    const Sample sample = curve(s);
    return std::pair(border.value(sample), border.slope(sample));
  };
  if ((f0 < 0) != (f1 < 0)) {
    cuts.push_back(root(f, s0, s1, f0 < 0));
    return;
  }
  // The curve may cross twice if it turns towards the border in between. It bends in one direction
  // only, so its tangents bound it.
  const double d0 = border.slope(at0), d1 = border.slope(at1), step = s1 - s0;
  const double towards = f0 < 0 ? -1 : 1;
  if (towards * d0 >= 0 || towards * d1 <= 0) return;
  const double meet = (f1 - f0 - d1 * step) / (d0 - d1);
  if (towards * (f0 + d0 * meet) > 0) return;
  const double turn = extremum(curve, border, s0, s1, towards > 0);
  if ((border.value(curve(turn)) < 0) == (f0 < 0)) return;
  cuts.push_back(root(f, s0, turn, f0 < 0));
  cuts.push_back(root(f, turn, s1, f0 >= 0));
}

/// Whether the distorted radius increases monotonically from the axis to x: beyond a fold, a pixel
/// is not unique.
bool grows_to(const Camera& camera, const Eigen::Vector2d& x) {
  const Curve ray{camera, Eigen::Vector2d::Zero(), x};
  const Eigen::Vector2d outwards(camera.f_px() * camera.ax() * x[0], camera.f_px() * x[1]);
  for (double share : {0.25, 0.5, 0.75, 1.0}) {
    if (x.squaredNorm() > 0 && !(ray(share).slope.dot(outwards) > 0)) return false;
  }
  return true;
}

/// The ray of a pixel, on this side of any fold.
std::optional<Eigen::Vector2d> plain_ray(const Camera& camera, const Eigen::Vector2d& pixel) {
  const auto ray = try_unproject(camera, pixel);
  if (!ray || !grows_to(camera, ray->head<2>())) return std::nullopt;
  return Eigen::Vector2d(ray->head<2>());
}

/// The ray of the outermost pixel between the image centre and `pixel` that has one.
Eigen::Vector2d outermost_ray(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d centre = 0.5 * (camera.size_px.cast<double>() - Eigen::Vector2d::Ones());
  auto ray = plain_ray(camera, centre);
  if (!ray) {
    throw Error("camera \"" + camera.name + "\"",
                "its distortion cannot be inverted at the image centre",
                "change the coefficients, or reduce psi_c");
  }
  double good = 0, bad = 1;
  for (int i = 0; i < 30; ++i) {
    const double share = 0.5 * (good + bad);
    if (const auto tried = plain_ray(camera, centre + share * (pixel - centre))) {
      ray = tried;
      good = share;
    } else {
      bad = share;
    }
  }
  return *ray;
}

}  // namespace

ViewFrustum::ViewFrustum(const Camera& camera, double near_m, double far_m)
    : camera_(camera), near_m_(near_m), far_m_(far_m) {
  const std::string place = "camera \"" + camera.name + "\"";
  if (!(near_m > 0 && far_m > near_m)) {
    throw Error(place, "the depth range is empty", "use 0 < near_m < far_m");
  }
  if (camera.size_px.minCoeff() < 1)
    throw Error(place, "the image size is not positive", "set size_px");
  check_parameters(camera);
  bound_border();
}

void ViewFrustum::bound_border() {
  const double w = camera_.size_px[0], h = camera_.size_px[1], none = 1e300;
  outer_ = {none, none, -none, -none};
  inner_ = {-none, -none, none, none};
  double fold2 = none;  // squared distance from the axis at which the image folds
  const auto visit = [&](double u, double v) {
    const Eigen::Vector2d pixel(u - 0.5, v - 0.5);
    auto x = plain_ray(camera_, pixel);
    if (!x) {
      x = outermost_ray(camera_, pixel);
      fold2 = std::min(fold2, x->squaredNorm());
    }
    outer_ = {std::min(outer_.x0, (*x)[0]), std::min(outer_.y0, (*x)[1]),
              std::max(outer_.x1, (*x)[0]), std::max(outer_.y1, (*x)[1])};
    outer_radius2_ = std::max(outer_radius2_, x->squaredNorm());
    return *x;
  };
  for (int i = 0; i <= samples_a_side; ++i) {
    const double share = static_cast<double>(i) / samples_a_side;
    inner_.x0 = std::max(inner_.x0, visit(0, h * share)[0]);
    inner_.x1 = std::min(inner_.x1, visit(w, h * share)[0]);
    inner_.y0 = std::max(inner_.y0, visit(w * share, 0)[1]);
    inner_.y1 = std::min(inner_.y1, visit(w * share, h)[1]);
  }
  const double dx = slack * (outer_.x1 - outer_.x0), dy = slack * (outer_.y1 - outer_.y0);
  outer_ = {outer_.x0 - dx, outer_.y0 - dy, outer_.x1 + dx, outer_.y1 + dy};
  inner_ = {inner_.x0 + dx, inner_.y0 + dy, inner_.x1 - dx, inner_.y1 - dy};
  outer_radius2_ *= (1 + slack) * (1 + slack);
  if (fold2 < outer_radius2_) {  // beyond the fold nothing is imaged
    outer_radius2_ = fold2 * (1 - slack) * (1 - slack);
    const double corner2 = std::max({inner_.x0 * inner_.x0, inner_.x1 * inner_.x1}) +
                           std::max({inner_.y0 * inner_.y0, inner_.y1 * inner_.y1});
    const double shrink = std::min(1.0, std::sqrt(outer_radius2_ / corner2));
    inner_ = {shrink * inner_.x0, shrink * inner_.y0, shrink * inner_.x1, shrink * inner_.y1};
  }
}

ViewVolume::ViewVolume(const Eigen::AlignedBox3d& around, const std::array<Plane, 4>& sides)
    : around_(around) {
  for (int i = 0; i < 4; ++i) {
    normals_.row(i) = sides[static_cast<std::size_t>(i)].normal();
    offsets_[i] = sides[static_cast<std::size_t>(i)].offset();
  }
  reach_ = normals_.cwiseAbs();
}

ViewVolume ViewFrustum::volume(const Pose& T_camera_world) const {
  constexpr double margin_m = 1e-3;
  const Pose T_world_camera = T_camera_world.inverse();
  const auto side = [&](double x, double y, double z) {
    const Eigen::Vector3d normal = T_world_camera.R * Eigen::Vector3d(x, y, z).normalized();
    return ViewVolume::Plane(normal, margin_m - normal.dot(T_world_camera.t));
  };
  const std::array<ViewVolume::Plane, 4> sides{side(1, 0, -outer_.x0), side(-1, 0, outer_.x1),
                                               side(0, 1, -outer_.y0), side(0, -1, outer_.y1)};
  Eigen::AlignedBox3d box(T_world_camera.t);
  for (const double x : {outer_.x0, outer_.x1}) {
    for (const double y : {outer_.y0, outer_.y1}) {
      box.extend(T_world_camera * (far_m_ * Eigen::Vector3d(x, y, 1)));
    }
  }
  if (!(box.max() - box.min()).allFinite()) {  // far_m is infinite
    const Eigen::Vector3d all = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    return {{-all, all}, sides};
  }
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(margin_m);
  return {{box.min() - margin, box.max() + margin}, sides};
}

bool ViewFrustum::clip(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Stretch& s) const {
  s = {0, 1};
  return keep(a.z() - near_m_, b.z() - near_m_, s) && keep(far_m_ - a.z(), far_m_ - b.z(), s) &&
         keep(a.x() - outer_.x0 * a.z(), b.x() - outer_.x0 * b.z(), s) &&
         keep(outer_.x1 * a.z() - a.x(), outer_.x1 * b.z() - b.x(), s) &&
         keep(a.y() - outer_.y0 * a.z(), b.y() - outer_.y0 * b.z(), s) &&
         keep(outer_.y1 * a.z() - a.y(), outer_.y1 * b.z() - b.y(), s);
}

void ViewFrustum::cut_at_border(const ProjectedSegment& picture, std::vector<double>& cuts) const {
  const Curve curve{camera_, picture.x0, picture.x1 - picture.x0};
  const double w = camera_.size_px[0], h = camera_.size_px[1];
  const std::array<Border, 4> borders{
      {{0, 1, -0.5}, {0, -1, w - 0.5}, {1, 1, -0.5}, {1, -1, h - 0.5}}};
  cuts.assign({0.0, 1.0});
  Sample before = curve(0);
  for (int i = 0; i < intervals; ++i) {
    const double s0 = static_cast<double>(i) / intervals;
    const double s1 = static_cast<double>(i + 1) / intervals;
    const Sample after = curve(s1);
    for (const Border& border : borders) {
      append_crossings(curve, border, s0, s1, before, after, cuts);
    }
    before = after;
  }
  // A circle around the axis excludes the folds of the distortion.
  const double aa = curve.direction.squaredNorm(), ab = picture.x0.dot(curve.direction);
  const double root2 = ab * ab - aa * (picture.x0.squaredNorm() - outer_radius2_);
  if (aa > 0 && root2 > 0) {
    for (double s : {(-ab - std::sqrt(root2)) / aa, (-ab + std::sqrt(root2)) / aa}) {
      if (s > 0 && s < 1) cuts.push_back(s);
    }
  }
  std::sort(cuts.begin(), cuts.end());
}

void ViewFrustum::in_image(const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b,
                           const Stretch& clipped,
                           std::vector<Stretch>& inside) const {
  inside.clear();
  const ProjectedSegment picture(a, b, clipped);
  if (inner_.contains(picture.x0) && inner_.contains(picture.x1)) {
    inside.push_back(clipped);
    return;
  }
  thread_local std::vector<double> cuts;
  cut_at_border(picture, cuts);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    // Between two cuts, everything is in the image or nothing is.
    const double s = 0.5 * (cuts[i] + cuts[i + 1]);
    const Eigen::Vector2d x = picture.x0 + s * (picture.x1 - picture.x0);
    if (x.squaredNorm() > outer_radius2_ ||
        !vernier::in_image(camera_, project(camera_, {x[0], x[1], 1}))) {
      continue;
    }
    const double t0 = picture.t_at(cuts[i]), t1 = picture.t_at(cuts[i + 1]);
    if (!inside.empty() && inside.back().t1 >= t0) {
      inside.back().t1 = t1;
    } else if (t1 > t0) {
      inside.push_back({t0, t1});
    }
  }
}

bool ViewFrustum::contains(const Eigen::Vector3d& point) const {
  if (!(point.z() >= near_m_ && point.z() <= far_m_)) return false;
  const Eigen::Vector2d x = point.head<2>() / point.z();
  return outer_.contains(x) && x.squaredNorm() <= outer_radius2_ &&
         vernier::in_image(camera_, project(camera_, point));
}

}  // namespace vernier::sim::internal
