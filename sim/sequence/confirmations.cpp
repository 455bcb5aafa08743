// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/confirmations.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/join/line_fit.h"
#include "sim/sequence/expected_lines.h"
#include "sim/sequence/line_in_view.h"
#include "sim/sequence/segments_on_line.h"
#include "sim/sequence/sequence_samples.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

using Eigen::Vector3d;

namespace {

constexpr double shown_share = 0.8, confirming_share = 0.3;
constexpr double nearest = 0.7, farthest = 1 / nearest;  // of its distance in its own view
constexpr int least_asked = 2;

}  // namespace

Confirmations::Confirmations(const Camera& camera,
                             std::span<const SequenceView> views,
                             const SequenceOptions& options)
    : camera_(camera), views_(views), options_(options) {
  for (const SequenceView& view : views) votes_.emplace_back(view.segments.size());
}

void Confirmations::look(int view, const std::optional<stereo::internal::DepthImage>& depth) {
  const PlacedCamera placed = placed_camera(camera_, views_[view].T_world_camera);
  const int reach = options_.neighbour_views, count = static_cast<int>(views_.size());
  for (int v = std::max(0, view - reach); v <= std::min(count - 1, view + reach); ++v) {
    if (v == view) continue;
    const Pose& T = views_[v].T_world_camera;
    for (std::size_t i = 0; i < views_[v].segments.size(); ++i) {
      const SequenceSegment& segment = views_[v].segments[i];
      if (segment.image_px.length_px() < options_.min_length_px) continue;
      const auto in_world = localise::internal::in_world(segment.in_space, T, options_.join);
      if (localise::internal::sigma_across(in_world) > options_.join.max_sigma_m) continue;
      const Vector3d middle = 0.5 * (in_world.a_m + in_world.b_m);
      const double ratio = (placed.T_camera_world * middle).norm() / (middle - T.t).norm();
      if (ratio < nearest || ratio > farthest) continue;
      auto line = line_in_view(placed, in_world.a_m, in_world.b_m, border_margin_px);
      if (!line || line->length_px() < options_.min_length_px) continue;
      const double inside =
          (line->at_m.back() - line->at_m.front()).norm() / (in_world.b_m - in_world.a_m).norm();
      if (depth) {
        keep_where_depths_agree(*depth, options_.depth_floor_m, options_.depth_share, *line);
      }
      if (inside * line->shown_count() < shown_share * line->length_px()) continue;
      const auto confirms = [&](double off_px) {
        return segments_on(*line, views_[view].segments, off_px, options_).found_px >=
               confirming_share * line->shown_count();
      };
      Votes& votes = votes_[v][i];
      ++votes.asked;
      votes.confirmed = votes.confirmed || confirms(0);
      for (std::size_t k = 0; k < votes.by_chance.size(); ++k) {
        votes.by_chance[k] = votes.by_chance[k] || confirms(displaced_px[k]);
      }
    }
  }
}

std::vector<ConfirmedSample> Confirmations::take() const {
  std::vector<ConfirmedSample> samples;
  for (std::size_t v = 0; v < votes_.size(); ++v) {
    for (std::size_t i = 0; i < votes_[v].size(); ++i) {
      const Votes& votes = votes_[v][i];
      const double chance =
          static_cast<double>(std::count(votes.by_chance.begin(), votes.by_chance.end(), true)) /
          static_cast<double>(votes.by_chance.size());
      if (votes.asked < least_asked || chance == 1) continue;
      const SequenceSegment& segment = views_[v].segments[i];
      const auto& s = segment.in_space;
      samples.push_back({sample_at(static_cast<int>(v), 0.5 * (s.a_m + s.b_m), s.b_m - s.a_m,
                                   segment.image_px.length_px()),
                         votes.confirmed, votes.asked, chance});
    }
  }
  return samples;
}

}  // namespace vernier::sim::internal
