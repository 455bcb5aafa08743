// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <numbers>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/thread_clock.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "sim/corner_appearance.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/study/reconstruct.h"
#include "sim/told_rigs.h"
#include "sim/uncertainty_source.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace vernier::internal;
using namespace internal;

namespace {

/// Offset of the trial numbers of maps, so that maps and queries use different streams.
constexpr std::uint32_t map_trial = 0x80000000u;

bool has_mount_error(const SourceSettings& sources) {
  return sources.mount_height_m > 0 || sources.mount_pitch_deg > 0 || sources.mount_roll_deg > 0;
}

/// The changed world of an experiment, given or made.
std::shared_ptr<const ChangedWorld> changed_world(std::shared_ptr<const ChangedWorld> given,
                                                  const Visibility& recorded,
                                                  const ExperimentSettings& settings) {
  if (given || !(settings.sources.moved > 0)) return given;
  check(settings.sources, "sources");
  return std::make_shared<const ChangedWorld>(recorded.world(), settings.sources.moved,
                                              settings.seed);
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

/// The rig of a draw that did not fail.
Rig required(ToldRig told, const char* what, std::uint32_t number) {
  if (!told.failure.empty()) {
    throw Error(fmt::format("calibration for {} {}", what, number), told.failure,
                "give a smaller psi_c (sources.calibration) or, with [calibration], more views");
  }
  return std::move(told.rig);
}

/// The localiser's answer; failed where the localiser throws what is no Error, or answers with
/// numbers that are none.
LocalisationAnswer answer_of(const Localiser& localiser, const std::vector<Look>& looks) {
  LocalisationAnswer failed;
  failed.status = LocalisationStatus::failed;
  try {
    LocalisationAnswer answer =
        looks.size() == 1 ? localiser.localise(looks[0].view) : localiser.localise_looks(looks);
    constexpr double rounding = 1e-9;
    const Pose2D& pose = answer.pose;
    const bool has_pose = answer.status == LocalisationStatus::answered ||
                          answer.status == LocalisationStatus::unsure;
    if (!(answer.probability >= -rounding && answer.probability <= 1 + rounding)) {
      failed.failure = fmt::format("the localiser states a probability of {}", answer.probability);
    } else if (has_pose && !(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) &&
                             std::isfinite(pose.heading_rad))) {
      failed.failure = "the localiser's pose is not finite";
    } else if (!std::isfinite(answer.next_turn_rad)) {
      failed.failure = "the localiser's next turn is not finite";
    } else {
      return answer;
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    failed.failure = "the localiser threw: " + printable(error.what());
  } catch (...) {
    failed.failure = "the localiser threw what is no std::exception";
  }
  return failed;
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
  return map_views(visibility, true_rig, settings, {settings.mount, 0});
}

MapViews map_views(const Visibility& visibility,
                   const Rig& true_rig,
                   const ExperimentSettings& settings,
                   const TrueMount& stands) {
  MapViews looks;
  NoiseFreeViewOptions looking = look_from(stands);
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
                                               std::shared_ptr<const QueryPlaces> places,
                                               std::shared_ptr<const ChangedWorld> changed,
                                               std::shared_ptr<const ToldRigs> told)
    : visibility_(visibility),
      changed_(changed_world(std::move(changed), visibility, settings)),
      queried_(changed_ ? changed_->visibility : visibility),
      truth_(rig.rig),
      told_(std::move(told)),
      map_views_(std::move(looks)),
      places_(std::move(places)),
      settings_(std::move(settings)),
      sensor_(rig.rig, settings_.sources) {
  if (!places_ && settings_.protocol == QueryProtocol::free) {
    places_ =
        std::make_shared<const QueryPlaces>(queried_, settings_.protocol, settings_.mount.height_m);
  }
  if (!told_ && settings_.sources.calibration > 0) {
    told_ = drawn_rigs(RigSampler(rig, "rig"), settings_.sources.calibration, settings_.seed);
  }
  check(settings_.appearance, "appearance of corners");
  if (needs_corners(settings_.method, settings_.localiser)) {
    appearance_ = std::make_unique<CornerAppearance>(visibility.world(), settings_.appearance);
    if (changed_) {
      changed_appearance_ =
          std::make_unique<CornerAppearance>(changed_->world, settings_.appearance);
    }
  }
}

std::vector<StereoCorner> LocalisationExperiment::described(const StereoObservation& sighting,
                                                            const Pose2D& pose,
                                                            const SensingDraw& draw,
                                                            const CornerAppearance* of) const {
  if (!of) return {};
  return stereo_corners(sighting, *of, settings_.sources, eye_of(pose, settings_.mount), draw);
}

ToldRig LocalisationExperiment::told_rig(std::uint32_t draw) const {
  return told_ ? told_->told(draw) : ToldRig{truth_, {}};
}

Rig LocalisationExperiment::estimator_rig(std::uint32_t trial) const {
  return required(told_rig(trial), "trial", trial);
}
Rig LocalisationExperiment::map_estimator_rig(std::uint32_t block) const {
  return required(told_rig(map_trial + block), "map", block);
}

std::shared_ptr<const MapViews> LocalisationExperiment::views_of(std::uint32_t block) const {
  if (!has_mount_error(settings_.sources)) {
    if (!map_views_) {
      throw Error("localisation experiment", "has no views of the map", "give those of map_views");
    }
    return map_views_;
  }
  const TrueMount stands =
      draw_mount(settings_.mount, settings_.sources, settings_.seed, map_trial + block);
  return std::make_shared<const MapViews>(map_views(visibility_, truth_, settings_, stands));
}

TopologicalMap LocalisationExperiment::record(std::uint32_t block,
                                              const Rig& rig,
                                              const MapViews& views,
                                              std::string& failure) const {
  TopologicalMap map;
  const auto told = std::make_shared<const Rig>(rig);
  map.nodes.reserve(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const NoiseFreeView& place = views[i];
    const SensingDraw draw{
        .seed = settings_.seed, .trial = map_trial + block, .frame = static_cast<std::uint32_t>(i)};
    StereoObservation sighting = sensor_.sense(place, draw);
    if (!sighting.failure.empty()) {
      failure = std::move(sighting.failure);
      break;
    }
    map.nodes.push_back({place.pose, interpret(rig, sighting, settings_)});
    PlaceView& view = map.nodes.back().view;
    view.corners = described(sighting, place.pose, draw, appearance_.get());
    // Maps are large: one copy of the rig, and nothing that is not used.
    view.rig = told;
    view.monocular_lines = {};
    view.lines.shrink_to_fit();
    view.image_lines.shrink_to_fit();
  }
  return map;
}

TopologicalMap LocalisationExperiment::record_map(std::uint32_t block, const Rig& rig) const {
  std::string failure;
  TopologicalMap map = record(block, rig, *views_of(block), failure);
  if (!failure.empty()) throw Error("recording of the map", failure, "correct the source of yours");
  return map;
}

Pose2D LocalisationExperiment::place_of(std::uint32_t trial) const {
  return places_ ? places_->draw(settings_.seed, trial)
                 : draw_query(queried_, settings_.protocol, settings_.mount.height_m,
                              settings_.seed, trial);
}

TrialResult LocalisationExperiment::run_trial(std::uint32_t trial,
                                              const Rig& told,
                                              const TopologicalMap& map,
                                              const Localiser& localiser) const {
  TrialResult result;
  result.trial = trial;
  result.truth = place_of(trial);
  NoiseFreeViewOptions looking =
      look_from(draw_mount(settings_.mount, settings_.sources, settings_.seed, trial));
  looking.with_corners = true;
  std::vector<Look> looks;
  LocalisationAnswer answer;
  StereoObservation first;
  double turn_rad = 0;
  for (int taken = 0; taken < std::max(1, settings_.looks); ++taken) {
    Pose2D pose = result.truth;
    pose.heading_rad += turn_rad;
    const NoiseFreeView seen = look(queried_, truth_, pose, looking);
    const SensingDraw draw{
        .seed = settings_.seed, .trial = trial, .frame = static_cast<std::uint32_t>(taken)};
    StereoObservation sighting = sensor_.sense(seen, draw);
    if (!sighting.failure.empty()) {
      answer = {};
      answer.status = LocalisationStatus::failed;
      answer.failure = sighting.failure;
      if (looks.empty()) looks.push_back({});
      break;
    }
    std::vector<StereoCorner> corners =
        described(sighting, pose, draw, changed_ ? changed_appearance_.get() : appearance_.get());

    const ThreadClock clock;
    looks.push_back({interpret(told, sighting, settings_), turn_rad});
    looks.back().view.corners = std::move(corners);
    answer = answer_of(localiser, looks);
    result.cpu_ms += clock.cpu_ms() + answer.program_cpu_ms;
    result.wall_ms += clock.wall_ms();

    if (taken == 0) first = std::move(sighting);
    if (answer.status == LocalisationStatus::answered && answer.next_turn_rad == 0) break;
    turn_rad = answer.next_turn_rad != 0 ? answer.next_turn_rad : newest_turn_rad(looks);
  }

  result.status = answer.status;
  result.failure = answer.failure;
  result.corners = static_cast<int>(first.corners.size());
  result.corner_mismatches =
      static_cast<int>(std::count_if(first.corners.begin(), first.corners.end(),
                                     [](const SensedCorner& corner) { return corner.mismatched; }));
  result.lines = static_cast<int>(looks[0].view.lines.size());
  result.looks = static_cast<int>(looks.size());
  result.score = answer.score;
  result.runner_up = answer.runner_up;
  result.probability = std::clamp(answer.probability, 0.0, 1.0);  // for rounding
  result.error = result.node_error_m = result.heading_error_rad =
      std::numeric_limits<double>::quiet_NaN();
  if (result.answered() || answer.status == LocalisationStatus::unsure) {
    const bool has_node = answer.node >= 0 && answer.node < static_cast<int>(map.nodes.size());
    result.answer = answer.pose;
    result.node = has_node ? map.nodes[answer.node].pose : answer.pose;
    result.error = distance_m(answer.pose, result.truth);
    result.node_error_m = distance_m(result.node, result.truth);
    result.heading_error_rad = heading_difference_rad(answer.pose, result.truth);
  }
  return result;
}

TrialResult LocalisationExperiment::spoilt_trial(std::uint32_t trial, std::string failure) const {
  TrialResult spoilt;
  spoilt.trial = trial;
  spoilt.truth = place_of(trial);
  spoilt.status = LocalisationStatus::failed;
  spoilt.failure = std::move(failure);
  spoilt.error = spoilt.node_error_m = spoilt.heading_error_rad =
      std::numeric_limits<double>::quiet_NaN();
  return spoilt;
}

std::vector<TrialResult> LocalisationExperiment::run_block(const TrialBlock& trials) const {
  const auto [block, first, count] = trials;
  std::vector<TrialResult> results;
  results.reserve(count);
  const std::shared_ptr<const MapViews> views = views_of(block);
  TopologicalMap map;
  std::string failure;  // of a calibration or of a source, when the map was recorded
  std::unique_ptr<Localiser> localiser;
  for (std::uint32_t trial = first; trial < first + count; ++trial) {
    const ToldRig told = told_rig(trial);
    const bool same = settings_.map_rig == MapRig::same;
    if (same || trial == first) {
      const ToldRig of_map = same ? told : told_rig(map_trial + block);
      failure = of_map.failure;
      localiser.reset();
      if (failure.empty()) map = record(block, of_map.rig, *views, failure);
      if (failure.empty()) localiser = make_localiser(settings_.method, map, settings_.localiser);
    }
    // Without a map, or a rig of its own, a trial cannot be run.
    const std::string& why = failure.empty() ? told.failure : failure;
    results.push_back(why.empty() ? run_trial(trial, told.rig, map, *localiser)
                                  : spoilt_trial(trial, why));
  }
  return results;
}

}  // namespace vernier::sim
