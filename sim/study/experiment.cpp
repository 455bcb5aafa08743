// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "sim/corner_appearance.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/study/told_rig.h"
#include "sim/uncertainty_source.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace internal;

namespace {

/// Offset of the trial numbers of maps, so that maps and queries use different streams.
constexpr std::uint32_t map_trial = 0x80000000u;

double clock_ms(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

NoiseFreeViewOptions look_options(const ExperimentSettings& settings) {
  NoiseFreeViewOptions options;
  options.mount = settings.mount;
  return options;
}

PlaceView interpret(const Rig& told,
                    const StereoObservation& sighting,
                    const ExperimentSettings& settings) {
  PlaceView view =
      select_lines(reconstruct(told, sighting, settings), sighting.segments, settings.mount);
  view.rig = std::make_shared<const Rig>(told);
  view.monocular_lines = sighting.left_only;
  return view;
}

/// Of sixteen turns the one that is furthest from those of all looks.
double newest_turn_rad(const std::vector<Look>& looks) {
  constexpr int turns = 16;
  double best = 0, furthest = -1;
  for (int i = 0; i < turns; ++i) {
    const double turn = 2 * std::numbers::pi * i / turns;
    double nearest = 2 * std::numbers::pi;
    for (const Look& look : looks) {
      nearest =
          std::min(nearest, std::abs(std::remainder(turn - look.turn_rad, 2 * std::numbers::pi)));
    }
    if (nearest > furthest) {
      furthest = nearest;
      best = turn;
    }
  }
  return best;
}

}  // namespace

MapViews map_views(const Visibility& visibility,
                   const Rig& true_rig,
                   const ExperimentSettings& settings) {
  MapViews looks;
  NoiseFreeViewOptions looking = look_options(settings);
  looking.with_corners = needs_corners(settings.method, settings.localiser);
  for (const Pose2D& place :
       map_poses(visibility.world().route, settings.map_spacing_m, settings.map_headings)) {
    looks.push_back(look(visibility, true_rig, place, looking));
  }
  return looks;
}

LocalisationExperiment::LocalisationExperiment(const Visibility& visibility,
                                               const RigEstimate& rig,
                                               std::shared_ptr<const MapViews> looks,
                                               ExperimentSettings settings,
                                               std::shared_ptr<const QueryPlaces> places)
    : visibility_(visibility),
      rig_(rig),
      map_views_(std::move(looks)),
      places_(std::move(places)),
      settings_(std::move(settings)),
      sensor_(rig.rig, settings_.sources) {
  if (!places_ && settings_.protocol == QueryProtocol::free) {
    places_ = std::make_shared<const QueryPlaces>(visibility, settings_.protocol,
                                                  settings_.mount.height_m);
  }
  if (settings_.sources.calibration > 0) sampler_ = std::make_unique<RigSampler>(rig, "rig");
  check(settings_.appearance, "appearance of corners");
  if (needs_corners(settings_.method, settings_.localiser)) {
    appearance_ = std::make_unique<CornerAppearance>(visibility.world(), settings_.appearance);
  }
}

std::vector<StereoCorner> LocalisationExperiment::described(const StereoObservation& sighting,
                                                            const Pose2D& pose,
                                                            const SensingDraw& draw) const {
  if (!appearance_) return {};
  return stereo_corners(sighting, *appearance_, settings_.sources, eye_of(pose, settings_.mount),
                        draw);
}

Rig LocalisationExperiment::draw_rig(std::uint32_t trial, bool of_map) const {
  if (!sampler_) return rig_.rig;
  return sampler_->sample(settings_.sources.calibration, settings_.seed,
                          of_map ? map_trial + trial : trial);
}

Rig LocalisationExperiment::estimator_rig(std::uint32_t trial) const {
  return draw_rig(trial, false);
}
Rig LocalisationExperiment::map_estimator_rig(std::uint32_t block) const {
  return draw_rig(block, true);
}

TopologicalMap LocalisationExperiment::record_map(std::uint32_t block, const Rig& rig) const {
  TopologicalMap map;
  const auto told = std::make_shared<const Rig>(rig);
  map.nodes.reserve(map_views_->size());
  for (std::size_t i = 0; i < map_views_->size(); ++i) {
    const NoiseFreeView& place = (*map_views_)[i];
    const SensingDraw draw{
        .seed = settings_.seed, .trial = map_trial + block, .frame = static_cast<std::uint32_t>(i)};
    const StereoObservation sighting = sensor_.sense(place, draw);
    map.nodes.push_back({place.pose, interpret(rig, sighting, settings_)});
    PlaceView& view = map.nodes.back().view;
    view.corners = described(sighting, place.pose, draw);
    // Maps are large: one copy of the rig, and nothing that is not used.
    view.rig = told;
    view.monocular_lines = {};
    view.lines.shrink_to_fit();
    view.image_lines.shrink_to_fit();
  }
  return map;
}

TrialResult LocalisationExperiment::run_trial(std::uint32_t trial,
                                              const Rig& told,
                                              const TopologicalMap& map,
                                              const Localiser& localiser) const {
  TrialResult result;
  result.trial = trial;
  result.truth = places_ ? places_->draw(settings_.seed, trial)
                         : draw_query(visibility_, settings_.protocol, settings_.mount.height_m,
                                      settings_.seed, trial);
  NoiseFreeViewOptions looking = look_options(settings_);
  looking.with_corners = true;
  std::vector<Look> looks;
  LocalisationAnswer answer;
  StereoObservation first;
  double turn_rad = 0;
  for (int taken = 0; taken < std::max(1, settings_.looks); ++taken) {
    Pose2D pose = result.truth;
    pose.heading_rad += turn_rad;
    const NoiseFreeView seen = look(visibility_, rig_.rig, pose, looking);
    const SensingDraw draw{
        .seed = settings_.seed, .trial = trial, .frame = static_cast<std::uint32_t>(taken)};
    StereoObservation sighting = sensor_.sense(seen, draw);
    std::vector<StereoCorner> corners = described(sighting, pose, draw);

    const double cpu = clock_ms(CLOCK_THREAD_CPUTIME_ID), wall = clock_ms(CLOCK_MONOTONIC);
    looks.push_back({interpret(told, sighting, settings_), turn_rad});
    looks.back().view.corners = std::move(corners);
    answer =
        looks.size() == 1 ? localiser.localise(looks[0].view) : localiser.localise_looks(looks);
    result.cpu_ms += clock_ms(CLOCK_THREAD_CPUTIME_ID) - cpu + answer.program_cpu_ms;
    result.wall_ms += clock_ms(CLOCK_MONOTONIC) - wall;

    if (taken == 0) first = std::move(sighting);
    if (answer.status == LocalisationStatus::answered) break;
    turn_rad = answer.next_turn_rad != 0 ? answer.next_turn_rad : newest_turn_rad(looks);
  }

  result.status = answer.status;
  result.corners = static_cast<int>(first.corners.size());
  result.corner_mismatches =
      static_cast<int>(std::count_if(first.corners.begin(), first.corners.end(),
                                     [](const SensedCorner& corner) { return corner.mismatched; }));
  result.lines = static_cast<int>(looks[0].view.lines.size());
  result.looks = static_cast<int>(looks.size());
  result.score = answer.score;
  result.runner_up = answer.runner_up;
  result.probability =
      std::isfinite(answer.probability) ? std::clamp(answer.probability, 0.0, 1.0) : 0;
  result.error_m = result.node_error_m = result.heading_error_rad =
      std::numeric_limits<double>::quiet_NaN();
  if (result.answered() || answer.status == LocalisationStatus::unsure) {
    const bool has_node = answer.node >= 0 && answer.node < static_cast<int>(map.nodes.size());
    result.answer = answer.pose;
    result.node = has_node ? map.nodes[answer.node].pose : answer.pose;
    result.error_m = distance_m(answer.pose, result.truth);
    result.node_error_m = distance_m(result.node, result.truth);
    result.heading_error_rad = heading_difference_rad(answer.pose, result.truth);
  }
  return result;
}

std::vector<TrialResult> LocalisationExperiment::run_block(const TrialBlock& trials) const {
  const auto [block, first, count] = trials;
  std::vector<TrialResult> results;
  results.reserve(count);
  TopologicalMap map;
  std::unique_ptr<Localiser> localiser;
  for (std::uint32_t trial = first; trial < first + count; ++trial) {
    const Rig told = estimator_rig(trial);
    const bool same = settings_.map_rig == MapRig::same;
    if (same || !localiser) {
      localiser.reset();
      map = record_map(block, same ? told : map_estimator_rig(block));
      localiser = make_localiser(settings_.method, map, settings_.localiser);
    }
    results.push_back(run_trial(trial, told, map, *localiser));
  }
  return results;
}

}  // namespace vernier::sim
