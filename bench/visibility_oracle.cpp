// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// How much of the visible length hidden-line removal gets wrong: every edge is sampled each half
// pixel by an oracle that shares no code with it (a ray against every surface that could be in the
// way), and each change between two samples is bisected to 1e-6 px.
//
//   visibility_oracle POSES WORLD.world.toml...
//
// Poses are drawn by the protocol `anywhere` (seed 1), the left eye of the nominal rig. What the
// samples jump over, a gap or a run shorter than their step, is asked for in its middle: if the
// oracle agrees there it is listed apart, with the length that lies in it.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/point_visibility.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double step_px = 0.5, bisected_px = 1e-6;

struct Piece {
  double t0, t1;
};

/// What is compared, in pixels of image length.
struct Tally {
  double visible = 0, differs = 0, apart = 0;
  int edges = 0, gaps = 0;

  void operator+=(const Tally& other) {
    visible += other.visible;
    differs += other.differs;
    apart += other.apart;
    edges += other.edges;
    gaps += other.gaps;
  }
};

/// One edge before a camera: the part between near and far, and where it lies in the image.
class SeenEdge {
 public:
  SeenEdge(
      const WorldSegment& segment, const Camera& camera, const Pose& T, double near, double far)
      : segment_(segment), camera_(camera), T_(T), a_(T * segment.a_m), b_(T * segment.b_m) {
    const double da = a_.z(), db = b_.z();
    const auto clip = [&](double fa, double fb) {  // keeps f > 0, linear in t
      if (fa < 0 && fb < 0) t1_ = -1;
      if (fa < 0 && fb >= 0) t0_ = std::max(t0_, fa / (fa - fb));
      if (fa >= 0 && fb < 0) t1_ = std::min(t1_, fa / (fa - fb));
    };
    clip(da - near, db - near);
    clip(far - da, far - db);
    // A pyramid around all that the lens could bring into the image.
    constexpr double wide = 1.5;
    for (const int axis : {0, 1}) {
      clip(wide * da - a_[axis], wide * db - b_[axis]);
      clip(wide * da + a_[axis], wide * db + b_[axis]);
    }
  }
  bool empty() const { return t1_ <= t0_; }
  double z(double t) const { return (1 - t) * a_.z() + t * b_.z(); }
  Vector3d at(double t) const { return segment_.a_m + t * (segment_.b_m - segment_.a_m); }
  Vector2d pixel(double t) const { return project(camera_, (1 - t) * a_ + t * b_); }
  double length_px(double t0, double t1) const { return (pixel(t1) - pixel(t0)).norm(); }

  /// The parameter at a share of the way in the undistorted image.
  double t_at(double share) const {
    const double z0 = z(t0_), z1 = z(t1_);
    return t0_ + (t1_ - t0_) * share * z0 / (z1 * (1 - share) + share * z0);
  }
  int samples() const {
    const double length = length_px(t0_, t1_);
    return 2 + static_cast<int>(std::min(length, 4000.0) * 1.5 / step_px);
  }

 private:
  const WorldSegment& segment_;
  const Camera& camera_;
  Pose T_;
  Vector3d a_, b_;
  double t0_ = 0, t1_ = 1;
};

/// The oracle, with the surfaces that reach into the triangle of the eye and the edge.
class EdgeOracle {
 public:
  EdgeOracle(const World& world,
             const std::vector<AlignedBox3d>& boxes,
             const WorldSegment& segment,
             const Camera& camera,
             const Pose& T,
             const VisibilityOptions& options)
      : near_world_(), oracle_{near_world_, camera, T, options} {
    AlignedBox3d triangle(T.inverse().t);
    triangle.extend(segment.a_m);
    triangle.extend(segment.b_m);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (triangle.intersects(boxes[i])) near_world_.surfaces.push_back(world.surfaces[i]);
    }
  }
  bool sees(const Vector3d& x) const { return oracle_.sees(x); }

 private:
  World near_world_;
  test::Oracle oracle_;
};

std::vector<Piece> seen_by(const EdgeOracle& oracle, const SeenEdge& edge) {
  std::vector<Piece> pieces;
  const int samples = edge.samples();
  bool before = false;
  double start = 0, last = 0;
  for (int k = 0; k <= samples; ++k) {
    const double t = edge.t_at(static_cast<double>(k) / samples);
    const bool now = oracle.sees(edge.at(t));
    double change = t;
    if (k > 0 && now != before) {
      double low = last, high = t;
      while (edge.length_px(low, high) > bisected_px && high - low > 1e-15) {
        const double middle = 0.5 * (low + high);
        (oracle.sees(edge.at(middle)) == before ? low : high) = middle;
      }
      change = 0.5 * (low + high);
    }
    if (now && !before) start = change;
    if (before && (!now || k == samples)) pieces.push_back({start, now ? t : change});
    before = now;
    last = t;
  }
  return pieces;
}

bool inside(const std::vector<Piece>& pieces, double t) {
  return std::any_of(pieces.begin(), pieces.end(),
                     [&](const Piece& piece) { return t > piece.t0 && t < piece.t1; });
}

Tally compare(const EdgeOracle& oracle,
              const SeenEdge& edge,
              const std::vector<Piece>& ours,
              const std::vector<Piece>& theirs) {
  Tally tally;
  std::vector<double> cuts;
  for (const auto* pieces : {&ours, &theirs}) {
    for (const Piece& piece : *pieces) cuts.insert(cuts.end(), {piece.t0, piece.t1});
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double t0 = cuts[i], t1 = cuts[i + 1], middle = 0.5 * (t0 + t1);
    if (t1 <= t0) continue;
    const bool we = inside(ours, middle), they = inside(theirs, middle);
    const double length = edge.length_px(t0, t1);
    if (they) tally.visible += length;
    if (we == they) continue;
    if (length < 2 * step_px && oracle.sees(edge.at(middle)) == we && length > 2 * bisected_px) {
      tally.apart += length;
      ++tally.gaps;
    } else {
      tally.differs += length;
    }
  }
  tally.edges = 1;
  return tally;
}

Tally compare_view(const World& world,
                   const Visibility& visibility,
                   const Camera& camera,
                   const Pose& T) {
  VisibilityOptions options;
  options.min_length_px = 0;
  std::vector<AlignedBox3d> boxes(world.surfaces.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (const Vector3d& point : world.surfaces[i].polygon_m) boxes[i].extend(point);
    boxes[i].min().array() -= 1e-9;
    boxes[i].max().array() += 1e-9;
  }
  const std::vector<VisibleInterval> runs = visibility.visible_intervals(camera, T, options);
  Tally tally;
  std::size_t next = 0;
  for (int i = 0; i < static_cast<int>(world.segments.size()); ++i) {
    std::vector<Piece> ours;
    for (; next < runs.size() && runs[next].segment == i; ++next) {
      ours.push_back({runs[next].t0, runs[next].t1});
    }
    const SeenEdge edge(world.segments[i], camera, T, options.near_m, options.far_m);
    if (edge.empty()) {
      if (!ours.empty()) std::printf("edge %d: seen, though out of sight\n", i);
      continue;
    }
    const EdgeOracle oracle(world, boxes, world.segments[i], camera, T, options);
    tally += compare(oracle, edge, ours, seen_by(oracle, edge));
  }
  return tally;
}

// Every surface as triangles: imported polygons are planar to 1 mm only, and where such a polygon
// lies is a matter of definition.
World with_triangles(World world) {
  std::vector<WorldSurface> triangles;
  for (const WorldSurface& surface : world.surfaces) {
    for (const std::vector<int>& loop : sim::internal::convex_pieces(surface.polygon_m)) {
      for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        triangles.push_back({{surface.polygon_m[loop[0]], surface.polygon_m[loop[i]],
                              surface.polygon_m[loop[i + 1]]},
                             surface.object});
      }
    }
  }
  world.surfaces = std::move(triangles);
  return world;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "visibility_oracle POSES WORLD.world.toml...\n");
    return 2;
  }
  try {
    const int poses = std::atoi(argv[1]);
    const Rig rig = datasets::nominal_truth();
    std::printf(
        "world | edges x views | visible px | differs px | share | gaps apart | their px\n");
    for (int k = 2; k < argc; ++k) {
      const World world = with_triangles(build_world(read_world(argv[k])));
      const Visibility visibility(world);
      const QueryPlaces places(visibility, QueryProtocol::anywhere, 1.2);
      Tally tally;
      for (int i = 0; i < poses; ++i) {
        const Pose T = T_left_world(places.draw(1, static_cast<std::uint32_t>(i)), {});
        tally += compare_view(world, visibility, rig.cameras[0], T);
      }
      std::printf("%s | %d | %.1f | %.3g | %.2g | %d | %.3g\n", world.name.c_str(), tally.edges,
                  tally.visible, tally.differs, tally.differs / tally.visible, tally.gaps,
                  tally.apart);
      std::fflush(stdout);
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "visibility_oracle: %s\n", error.what());
    return 2;
  }
}
