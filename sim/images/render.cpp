// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
#include "sim/images/tracer.h"
#include "stereo/grey_levels.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Shades what a pixel sees.
class Shader {
 public:
  Shader(const Eye& eye, const Camera& camera, bool shadows)
      : eye_(eye), pixel_(1 / (std::sqrt(12.0) * camera.f_px())), shadows_(shadows) {}

  /// Radiance of a face with figures, where the ray of this direction meets it. A figure has
  /// the texture of its face, at its own depth.
  double operator()(const SeenSurface& seen, const Vector3d& direction) const {
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
  std::uint64_t lamps_seen(const SeenSurface& seen, const Vector3d& direction) const {
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
    const SeenSurface& seen = seen_[same_.front()];
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
  bool is_evenly_lit(const SeenSurface& seen) const {
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
  std::vector<SeenSurface> seen_;
  std::array<SeenSurface, bundle_size> bundle_;
  std::vector<char> done_;
  std::vector<std::size_t> same_;  ///< samples of one face
};

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

}  // namespace vernier::sim::internal
