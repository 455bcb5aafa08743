// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/sequence_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "localise/join/line_fit.h"
#include "localise/joined_lines.h"
#include "sim/sequence/confirmations.h"
#include "sim/sequence/expected_lines.h"
#include "sim/sequence/line_in_view.h"
#include "sim/sequence/segments_on_line.h"
#include "stereo/image/depth_image.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace localise::internal;
using Eigen::Vector2d;
using Eigen::Vector3d;
using stereo::internal::DepthImage;

namespace {

constexpr int close_views = 3;            // whose ends are compared
constexpr double most_line_sigma_px = 1;  // a line less known is not asked for

/// An end of a segment, as a station of its joined line.
struct SeenEnd {
  double station_m = 0;
  bool inside = true;  ///< not at the border of the image
};

/// What a view shows of a line's two ends.
struct SeenEnds {
  int view = 0;
  std::array<SeenEnd, 2> ends;  ///< the lower station first
  double px_of_m = 0;
  SampleAt at;
};

class Sampling {
 public:
  Sampling(const Camera& camera,
           std::span<const SequenceView> views,
           const SequenceOptions& options)
      : camera_(camera), views_(views), options_(options), lines_(views, options) {
    ends_.resize(lines_.joined().lines.size());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      samples_.lines += lines_.is_known(static_cast<int>(i));
    }
  }

  void look(int view, const std::optional<DepthImage>& depth) {
    const PlacedCamera placed = placed_camera(camera_, views_[view].T_world_camera);
    for (std::size_t i = 0; i < lines_.joined().lines.size(); ++i) {
      const int line = static_cast<int>(i);
      if (!lines_.is_known(line)) continue;
      const localise::JoinedLine& joined = lines_.joined().lines[i];
      const auto in_view = line_in_view(placed, joined.a_m, joined.b_m, border_margin_px);
      if (!in_view || (options_.bracket_views > 0 && !lines_.is_bracketed(line, view))) continue;
      const double m_of_px =
          (in_view->at_m.back() - in_view->at_m.front()).norm() / in_view->length_px();
      const auto known = lines_.without(line, view, same_end_px * m_of_px);
      if (known) ask(placed, view, line, *known, depth);
    }
    note_segments(placed, view, depth);
  }

  SequenceSamples take() {
    compare_ends();
    return std::move(samples_);
  }

 private:
  /// Which segments lie on lines that enough others saw; not of those too uncertain to join.
  void note_segments(const PlacedCamera& placed, int view, const std::optional<DepthImage>& depth) {
    const Pose& T = views_[view].T_world_camera;
    const auto& segments = views_[view].segments;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const int line = lines_.joined().line_of[view][i];
      const double length_px = segments[i].image_px.length_px();
      if (line == localise::JoinedLines::none || length_px < options_.min_length_px) continue;
      const auto& s = segments[i].in_space;
      const int others = lines_.joined().lines[line].views - 1;
      SegmentSample sample{sample_at(view, 0.5 * (s.a_m + s.b_m), s.b_m - s.a_m, length_px),
                           others >= options_.other_views, true};
      auto shown = depth ? line_in_view(placed, T * s.a_m, T * s.b_m, 0) : std::nullopt;
      if (shown) {
        keep_where_depths_agree(*depth, options_.depth_floor_m, options_.depth_share, *shown);
        sample.depth_agrees = 2 * shown->shown_count() >= shown->length_px();
      }
      samples_.segments.push_back(sample);
    }
  }

  void ask(const PlacedCamera& placed,
           int view,
           int line,
           const KnownLine& known,
           const std::optional<DepthImage>& depth) {
    auto in_view = line_in_view(placed, known.at(known.seen_m.front().first),
                                known.at(known.seen_m.back().second), border_margin_px);
    if (!in_view) return;
    const Pose& T_world_camera = views_[view].T_world_camera;
    const auto station = [&](std::size_t i) {
      return known.fit.frame.station(T_world_camera * in_view->at_m[i]);
    };
    for (std::size_t i = 0; i < in_view->shown.size(); ++i) {
      if (!known.seen_at(station(i))) in_view->shown[i] = 0;
    }
    if (depth) {
      keep_where_depths_agree(*depth, options_.depth_floor_m, options_.depth_share, *in_view);
    }
    const int shown = in_view->shown_count();
    if (shown < options_.min_length_px) return;
    const std::size_t middle = in_view->at_m.size() / 2;
    if (known.across_px2(placed, in_view->across, station(middle)) >
        most_line_sigma_px * most_line_sigma_px) {
      return;
    }
    const Vector3d direction = placed.T_camera_world.R * known.fit.frame.axes.col(2);
    const SampleAt at = sample_at(view, in_view->at_m[middle], direction, shown);
    const auto& segments = views_[view].segments;
    const LineCover cover = segments_on(*in_view, segments, 0, options_);
    ExpectedSample expected{at,
                            double(shown),
                            double(cover.found_px),
                            0,
                            !cover.segments.empty(),
                            0,
                            int(cover.segments.size()),
                            line};
    ChanceSample chance{at, 0};
    for (const double off_px : displaced_px) {
      const LineCover by_chance = segments_on(*in_view, segments, off_px, options_);
      constexpr double count = std::size(displaced_px);
      expected.chance_px += by_chance.found_px / count;
      expected.chance_found += !by_chance.segments.empty() / count;
      for (const int s : by_chance.segments) chance.wrong += is_wrong(view, s, known) / count;
    }
    samples_.expected.push_back(expected);
    samples_.chance.push_back(chance);
    for (const int s : cover.segments) {
      samples_.found.push_back(found(placed, view, s, known, at));
      samples_.found.back().joined = lines_.joined().line_of[view][s] == line;
    }
    note_ends(placed, view, line, cover, at);
  }

  /// Whether the middle of a segment lies off the line along the ray, in the plane of both.
  bool is_wrong(int view, int segment, const KnownLine& known) const {
    const WorldSighting s = lines_.sighting(view, segment);
    const Vector3d eye = views_[view].T_world_camera.t;
    const Vector3d p = 0.5 * (s.a_m + s.b_m), ray = (p - eye).normalized();
    const Vector3d z = known.fit.frame.axes.col(2);
    const Vector3d e = (ray - z.dot(ray) * z).normalized();  // across the line, away from the eye
    if (!e.allFinite()) return false;
    const double station = known.fit.frame.station(p);
    const Eigen::Vector2d xy = known.fit.frame.axes.leftCols<2>().transpose() * e;
    Eigen::RowVector4d h;
    h << xy.transpose(), station * xy.transpose();
    const auto& C = s.covariance_m2;
    const Eigen::Matrix3d middle = 0.25 * (C.topLeftCorner<3, 3>() + C.bottomRightCorner<3, 3>() +
                                           C.topRightCorner<3, 3>() + C.bottomLeftCorner<3, 3>());
    const double shared2 = options_.join.shared_m * options_.join.shared_m;
    const double variance =
        e.dot(middle * e) + h * known.fit.covariance * h.transpose() + 2 * shared2;
    const double off = e.dot(p - known.at(station));
    return off * off > options_.wrong_sigma * options_.wrong_sigma * variance;
  }

  FoundSample found(const PlacedCamera& placed,
                    int view,
                    int segment,
                    const KnownLine& known,
                    const SampleAt& at) const {
    const stereo::ImageSegment& px = views_[view].segments[segment].image_px;
    const Pose& T = views_[view].T_world_camera;
    // the line in the image, and where on it the segment's ends are
    const Vector3d a = placed.T_camera_world * known.at(known.seen_m.front().first);
    const Vector3d b = placed.T_camera_world * known.at(known.seen_m.back().second);
    const Vector3d normal = a.cross(b);
    const auto off = [&](const Vector2d& end) {
      const Vector3d ray = placed.ray(end);
      const Vector2d gradient(normal.x() / placed.k.fx_px, normal.y() / placed.k.fy_px);
      return normal.dot(ray) / gradient.norm();
    };
    const auto station = [&](const Vector2d& end) {
      return station_of_ray(known.fit.frame.origin_m, known.fit.frame.axes.col(2), T.t,
                            T.R * placed.ray(end));
    };
    const Vector2d across(-(px.b_px - px.a_px).y(), (px.b_px - px.a_px).x());
    return {at,
            px.length_px(),
            off(px.b_px) - off(px.a_px),
            known.across_px2(placed, across.normalized(), station(px.b_px), station(px.a_px)),
            false,
            is_wrong(view, segment, known)};
  }

  /// Where a single segment that belongs to the line ends.
  void note_ends(
      const PlacedCamera& placed, int view, int line, const LineCover& cover, const SampleAt& at) {
    const int segment = cover.segments.size() == 1 ? cover.segments[0] : -1;
    if (segment < 0 || lines_.joined().line_of[view][segment] != line) return;
    const localise::JoinedLine& joined = lines_.joined().lines[line];
    const stereo::ImageSegment& px = views_[view].segments[segment].image_px;
    const Pose& T = views_[view].T_world_camera;
    SeenEnds ends{view, {}, 0, at};
    for (int end = 0; end < 2; ++end) {
      const Vector2d& p = end == 0 ? px.a_px : px.b_px;
      ends.ends[end] = {station_of_ray(joined.a_m, (joined.b_m - joined.a_m).normalized(), T.t,
                                       T.R * placed.ray(p)),
                        p.minCoeff() > border_margin_px &&
                            (placed.size_px.cast<double>() - p).minCoeff() > border_margin_px + 1};
    }
    if (ends.ends[0].station_m > ends.ends[1].station_m) std::swap(ends.ends[0], ends.ends[1]);
    ends.px_of_m = px.length_px() / (ends.ends[1].station_m - ends.ends[0].station_m);
    ends_[line].push_back(ends);
  }

  void compare_ends() {
    for (const std::vector<SeenEnds>& seen : ends_) {
      for (std::size_t i = 1; i < seen.size(); ++i) {
        const SeenEnds &before = seen[i - 1], &now = seen[i];
        if (now.view - before.view > close_views) continue;
        for (int end = 0; end < 2; ++end) {
          if (!before.ends[end].inside || !now.ends[end].inside) continue;
          const double off_m = now.ends[end].station_m - before.ends[end].station_m;
          samples_.ends.push_back({now.at, now.px_of_m * off_m});
        }
      }
    }
  }

  const Camera& camera_;
  std::span<const SequenceView> views_;
  const SequenceOptions& options_;
  ExpectedLines lines_;
  std::vector<std::vector<SeenEnds>> ends_;
  SequenceSamples samples_;
};

}  // namespace

SampleAt sample_at(int view,
                   const Vector3d& middle_m,
                   const Vector3d& direction,
                   double length_px) {
  const double cosine = std::abs(middle_m.normalized().dot(direction.normalized()));
  return {view, middle_m.norm(), std::acos(std::min(1.0, cosine)), length_px};
}

SequenceSamples sequence_samples(const Camera& camera,
                                 std::span<const SequenceView> views,
                                 const DepthOfView& depth,
                                 const SequenceOptions& options,
                                 const std::function<void(int done, int total)>& progress) {
  if (views.size() < 3) {
    throw Error("sequence", "has fewer than three views", "give more, of the same lines");
  }
  if (!depth && options.bracket_views < 1) {
    throw Error("sequence", "has no depth maps, and lines are expected in all views",
                "give depth maps, or ask only between views that saw a line");
  }
  Sampling sampling(camera, views, options);
  Confirmations confirmations(camera, views, options);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::optional<DepthImage> map = depth ? std::optional(depth(v)) : std::nullopt;
    sampling.look(static_cast<int>(v), map);
    confirmations.look(static_cast<int>(v), map);
    if (progress) progress(static_cast<int>(v + 1), static_cast<int>(views.size()));
  }
  SequenceSamples samples = sampling.take();
  samples.confirmed = confirmations.take();
  samples.with_depth = static_cast<bool>(depth);
  return samples;
}

}  // namespace vernier::sim::internal
