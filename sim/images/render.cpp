// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "sim/images/image_scene.h"
#include "sim/images/lighting.h"
#include "sim/images/materials.h"
#include "sim/images/pixel_rays.h"
#include "sim/images/ray_scene.h"
#include "stereo/grey_levels.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr int no_face = -1;

/// The eye of a view, its rays and what they hit.
class Eye {
 public:
  Eye(const ImageScene& scene, const Pose& T_camera_world)
      : scene_(scene),
        R_world_camera_(T_camera_world.R.transpose()),
        at_(T_camera_world.inverse().t),
        from_((at_ - scene.middle_m).cast<float>()) {}

  const ImageScene& scene() const { return scene_; }
  const Vector3d& at() const { return at_; }

  /// World direction of a ray (x / z, y / z): its length is 1 / cos of the angle to the axis, so a
  /// distance in units of it is the depth along the axis.
  Vector3d direction(const Vector2d& ray) const {
    return R_world_camera_ * Vector3d(ray.x(), ray.y(), 1);
  }

  RayBundle bundle(const Vector2d* rays, int count) const {
    RayBundle b;
    b.origin_m = from_;
    b.count = count;
    for (int i = 0; i < count; ++i) {
      const Vector3f d = direction(rays[i]).cast<float>();
      const auto k = static_cast<std::size_t>(i);
      b.x[k] = d.x();
      b.y[k] = d.y();
      b.z[k] = d.z();
    }
    return b;
  }

  /// Depth at which a ray meets a plane.
  template <class Plane>
  double depth(const Plane& plane, const Vector3d& direction) const {
    return (plane.distance_m - plane.normal.dot(at_)) / plane.normal.dot(direction);
  }

 private:
  const ImageScene& scene_;
  Eigen::Matrix3d R_world_camera_;
  Vector3d at_;
  Vector3f from_;
};

/// What the rays of a bundle see: a face and the figures painted over it.
struct Seen {
  int face = no_face;
  std::array<int, BundleCrossings::limit> figures;  ///< ascending
  int figure_count = 0;

  bool operator==(const Seen& other) const {
    return face == other.face && figure_count == other.figure_count &&
           std::equal(figures.begin(), figures.begin() + figure_count, other.figures.begin());
  }
};

/// Traces bundles of rays from an eye.
class Tracer {
 public:
  explicit Tracer(const Eye& eye) : eye_(eye) {}

  void trace(const RayBundle& rays, std::array<Seen, bundle_size>& seen) {
    const ImageScene& scene = eye_.scene();
    scene.solids.nearest(rays, hits_);
    std::array<float, bundle_size> farthest{};
    for (int i = 0; i < rays.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool hit = hits_.triangle[k] != no_triangle;
      seen[k].face = hit ? scene.face_of_triangle[hits_.triangle[k]] : no_face;
      seen[k].figure_count = 0;
      // A figure in the plane of its face may be hit a little behind it.
      if (hit) farthest[k] = 1.001F * hits_.distance[k] + slack_m;
    }
    scene.paint.crossings(rays, farthest, crossings_);
    for (int i = 0; i < rays.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (seen[k].face != no_face && crossings_.count[k] > 0) {
        add_figures(k, Vector3f(rays.x[k], rays.y[k], rays.z[k]), seen[k]);
      }
    }
  }

 private:
  static constexpr float slack_m = 0.01F;

  /// The figures within 3 cm in front of the face, or 1 mm behind it, across their plane.
  void add_figures(std::size_t ray, const Vector3f& direction, Seen& seen) const {
    constexpr double in_front_m = 0.03, behind_m = 1e-3;
    const ImageScene& scene = eye_.scene();
    for (int c = 0; c < crossings_.count[ray]; ++c) {
      const auto at = static_cast<std::size_t>(c);
      const int figure = scene.figure_of_triangle[crossings_.triangle[ray][at]];
      const PaintPlane& plane = scene.figures[static_cast<std::size_t>(figure)];
      const double before = (hits_.distance[ray] - crossings_.distance[ray][at]) *
                            std::abs(plane.normal.cast<float>().dot(direction));
      if (before > in_front_m || before < -behind_m) continue;
      int* const end = seen.figures.data() + seen.figure_count;
      int* const place = std::lower_bound(seen.figures.data(), end, figure);
      if (place != end && *place == figure) continue;
      std::copy_backward(place, end, end + 1);
      *place = figure;
      ++seen.figure_count;
    }
  }

  const Eye& eye_;
  BundleHits hits_;
  BundleCrossings crossings_;
};

/// Depth of what a ray sees: of the smallest figure there, which is the innermost of nested ones,
/// else of the face.
double depth_of(const Eye& eye, const Seen& seen, const Vector3d& direction) {
  const ImageScene& scene = eye.scene();
  const PaintPlane* smallest = nullptr;
  for (int i = 0; i < seen.figure_count; ++i) {
    const auto figure = static_cast<std::size_t>(seen.figures[static_cast<std::size_t>(i)]);
    const PaintPlane& plane = scene.figures[figure];
    if (smallest == nullptr || plane.area_m2 < smallest->area_m2) smallest = &plane;
  }
  if (smallest != nullptr) return eye.depth(*smallest, direction);
  return eye.depth(scene.faces[static_cast<std::size_t>(seen.face)], direction);
}

/// Shades what a pixel sees.
class Shader {
 public:
  Shader(const Eye& eye, const Camera& camera, bool shadows)
      : eye_(eye), pixel_(1 / (std::sqrt(12.0) * camera.f_px())), shadows_(shadows) {}

  /// Radiance of a face with figures, where the ray of this direction meets it. A figure has
  /// the texture of its face, at its own depth.
  double operator()(const Seen& seen, const Vector3d& direction) const {
    const ImageScene& scene = eye_.scene();
    const SolidFace& face = scene.faces[static_cast<std::size_t>(seen.face)];
    const double depth = depth_of(eye_, seen, direction);
    const Vector3d x = eye_.at() + depth * direction;
    const Vector3d normal = towards_eye(face, direction);
    double reflectance = reflectance_at(face, x, depth * pixel_, direction);
    for (int i = 0; i < seen.figure_count; ++i) {
      reflectance *=
          scene.figures[static_cast<std::size_t>(seen.figures[static_cast<std::size_t>(i)])].factor;
    }
    return std::clamp(reflectance, 0.02, 0.98) * light(face, x, normal);
  }

  /// A number that differs if other lamps reach the face there.
  std::uint64_t lamps_seen(const Seen& seen, const Vector3d& direction) const {
    const ImageScene& scene = eye_.scene();
    const SolidFace& face = scene.faces[static_cast<std::size_t>(seen.face)];
    const Vector3d x = eye_.at() + eye_.depth(face, direction) * direction;
    const Vector3d normal = towards_eye(face, direction);
    std::uint64_t number = 1;
    for (const int i : face.lamps) {
      const Vector3d& lamp = scene.lamps_m[static_cast<std::size_t>(i)];
      const bool reached =
          lamp_light(x, normal, lamp, scene.lighting) > 0 && !is_shaded(x, normal, lamp);
      number = 3 * number + (reached ? 2 : 1);
    }
    return number;
  }

 private:
  static Vector3d towards_eye(const SolidFace& face, const Vector3d& direction) {
    return face.normal.dot(direction) > 0 ? Vector3d(-face.normal) : face.normal;
  }

  double reflectance_at(const SolidFace& face,
                        const Vector3d& x,
                        double pixel_m,
                        const Vector3d& direction) const {
    const Material& m = eye_.scene().materials[static_cast<std::size_t>(face.material)];
    if (m.texture_contrast == 0) return m.reflectance;
    // A slanted surface is blurred as along its steepest direction.
    const double cosine = std::abs(face.normal.dot(direction)) / direction.norm();
    const double blur_m = pixel_m / std::max(cosine, 0.02);
    return m.reflectance *
           (1 + m.texture_contrast * m.texture.at(m.across.dot(x), m.up.dot(x), blur_m));
  }

  double light(const SolidFace& face, const Vector3d& x, const Vector3d& normal) const {
    const ImageScene& scene = eye_.scene();
    double sum = ambient_light(normal, scene.lighting);
    for (const int i : face.lamps) {
      const Vector3d& lamp = scene.lamps_m[static_cast<std::size_t>(i)];
      const double light = lamp_light(x, normal, lamp, scene.lighting);
      if (light > 0 && !(shadows_ && is_shaded(x, normal, lamp))) sum += light;
    }
    return sum;
  }

  bool is_shaded(const Vector3d& x, const Vector3d& normal, const Vector3d& lamp) const {
    constexpr double off_surface_m = 2e-3;
    const ImageScene& scene = eye_.scene();
    const Vector3d from = x + off_surface_m * normal - scene.middle_m;
    return scene.solids.blocked(from.cast<float>(), (lamp - scene.middle_m).cast<float>());
  }

  const Eye& eye_;
  double pixel_;  ///< standard deviation of a pixel's width at depth 1
  bool shadows_;
};

/// Renders rows.
class RowRenderer {
 public:
  RowRenderer(const Eye& eye, const Camera& camera, const RenderOptions& options)
      : eye_(eye),
        camera_(camera),
        tracer_(eye),
        shader_(eye, camera, options.shadows),
        shadows_(options.shadows),
        places_(sample_places(options.samples)),
        rays_(places_.size()),
        seen_(places_.size()) {}

  void operator()(int row, float* values) {
    const RowRays rays(camera_, row);
    for (int x = 0; x < camera_.size_px[0]; ++x) {
      for (std::size_t k = 0; k < places_.size(); ++k) {
        rays_[k] = rays.at(x, places_[k].x(), places_[k].y());
      }
      trace();
      values[x] = static_cast<float>(mean_of_faces());
    }
  }

 private:
  void trace() {
    for (std::size_t from = 0; from < rays_.size(); from += bundle_size) {
      const std::size_t count = std::min<std::size_t>(bundle_size, rays_.size() - from);
      tracer_.trace(eye_.bundle(&rays_[from], static_cast<int>(count)), bundle_);
      std::copy_n(bundle_.begin(), count, seen_.begin() + static_cast<std::ptrdiff_t>(from));
    }
  }

  /// Every face is shaded in the middle of its samples.
  double mean_of_faces() {
    done_.assign(seen_.size(), 0);
    double sum = 0;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      if (done_[k] || seen_[k].face == no_face) continue;
      same_.clear();
      for (std::size_t i = k; i < seen_.size(); ++i) {
        if (done_[i] || !(seen_[i] == seen_[k])) continue;
        done_[i] = 1;
        same_.push_back(i);
      }
      sum += sum_of_face();
    }
    return sum / static_cast<double>(seen_.size());
  }

  /// Sum over the samples of one face; each on its own where a shadow ends between them.
  double sum_of_face() const {
    const Seen& seen = seen_[same_.front()];
    if (shadows_ && !is_evenly_lit(seen)) {
      double sum = 0;
      for (const std::size_t i : same_) sum += shader_(seen, eye_.direction(rays_[i]));
      return sum;
    }
    Vector2d ray(0, 0);
    for (const std::size_t i : same_) ray += rays_[i];
    const auto count = static_cast<double>(same_.size());
    return count * shader_(seen, eye_.direction(ray / count));
  }

  /// Whether the same lamps reach the samples at the corners of the pattern.
  bool is_evenly_lit(const Seen& seen) const {
    const auto side = static_cast<std::size_t>(std::lround(std::sqrt(double(places_.size()))));
    const std::size_t n = same_.size();
    const std::uint64_t first = shader_.lamps_seen(seen, eye_.direction(rays_[same_[0]]));
    for (const std::size_t i : {std::min(side, n) - 1, n - std::min(side, n), n - 1}) {
      if (shader_.lamps_seen(seen, eye_.direction(rays_[same_[i]])) != first) return false;
    }
    return true;
  }

  const Eye& eye_;
  const Camera& camera_;
  Tracer tracer_;
  Shader shader_;
  bool shadows_;
  std::vector<Vector2d> places_, rays_;
  std::vector<Seen> seen_;
  std::array<Seen, bundle_size> bundle_;
  std::vector<char> done_;
  std::vector<std::size_t> same_;  ///< samples of one face
};

void depths_of_row(const Eye& eye, const Camera& camera, int row, double* depths) {
  Tracer tracer(eye);
  std::array<Seen, bundle_size> seen;
  std::array<Vector2d, bundle_size> rays;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (int from = 0; from < camera.size_px[0]; from += bundle_size) {
    const int count = std::min(bundle_size, camera.size_px[0] - from);
    for (int i = 0; i < count; ++i) {
      const auto ray = try_unproject(camera, Vector2d(from + i, row));
      rays[static_cast<std::size_t>(i)] = ray ? Vector2d(ray->head<2>()) : Vector2d(none, none);
    }
    tracer.trace(eye.bundle(rays.data(), count), seen);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      depths[from + i] =
          seen[k].face == no_face ? none : depth_of(eye, seen[k], eye.direction(rays[k]));
    }
  }
}

}  // namespace

void check_image_size(const Camera& camera) {
  constexpr double most_pixels = 1e8;
  const double pixels = double(camera.size_px[0]) * camera.size_px[1];
  if (camera.size_px.minCoeff() < 1 || pixels > most_pixels) {
    throw Error("camera '" + camera.name + "'",
                "an image of " + std::to_string(camera.size_px[0]) + "x" +
                    std::to_string(camera.size_px[1]) +
                    " px cannot be rendered (limit: 1e8 pixels)",
                "use a rig with a smaller size_px");
  }
}

stereo::GreyLevels render(const ImageScene& scene,
                          const Camera& camera,
                          const Pose& T_camera_world,
                          const RenderOptions& options) {
  constexpr int most_samples = 16;
  check_image_size(camera);
  if (options.samples < 1 || options.samples > most_samples) {
    throw Error("render", "the number of samples per side is not from 1 to 16", "use 4, say");
  }
  const auto width = static_cast<std::size_t>(camera.size_px[0]);
  const auto height = static_cast<std::size_t>(camera.size_px[1]);
  stereo::GreyLevels image{camera.size_px[0], camera.size_px[1],
                           std::vector<float>(width * height)};
  const Eye eye(scene, T_camera_world);
  vernier::internal::for_each_index(height, options.threads, [&](std::size_t row) {
    RowRenderer(eye, camera, options)(static_cast<int>(row), &image.values[row * width]);
  });
  return image;
}

std::vector<double> depths_m(const ImageScene& scene,
                             const Camera& camera,
                             const Pose& T_camera_world,
                             int threads) {
  check_image_size(camera);
  const auto width = static_cast<std::size_t>(camera.size_px[0]);
  const auto height = static_cast<std::size_t>(camera.size_px[1]);
  std::vector<double> depths(width * height);
  const Eye eye(scene, T_camera_world);
  vernier::internal::for_each_index(height, threads, [&](std::size_t row) {
    depths_of_row(eye, camera, static_cast<int>(row), &depths[row * width]);
  });
  return depths;
}

}  // namespace vernier::sim::internal
