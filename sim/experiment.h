// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "sim/corner_appearance.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"

namespace vernier::sim {

namespace internal {
class FreeFloor;
}

/// How far from the recorded route queries are drawn. It affects results more than any other
/// setting and is part of every result.
enum class QueryProtocol {
  near_path,  ///< ± 0.1 m across the route, ± 5°
  path,       ///< ± 0.3 m, ± 15°
  anywhere,   ///< ± 0.6 m, any heading
  free,       ///< all of the free floor that can be reached from the route, any heading
};

std::string_view name(QueryProtocol protocol);
/// Throws Error for a name other than near_path, path, anywhere, free.
QueryProtocol query_protocol(std::string_view name);

/// Where queries stand in a world: poses by trial, for one protocol. Immutable.
///
/// Uniform along the route, across it and in heading; drawn again (from the same stream) where a
/// robot of 0.12 m radius could not stand or a surface separates the position from the route. For
/// QueryProtocol::free, uniform over the floor that such a robot can get to from the route, which
/// takes a search of that floor at construction.
class QueryPlaces {
 public:
  /// Keeps a reference to `visibility`. Throws Error if the world has no route.
  QueryPlaces(const Visibility& visibility, QueryProtocol protocol, double eye_height_m);
  ~QueryPlaces();
  QueryPlaces(QueryPlaces&&) noexcept;

  /// Throws Error after 1000 draws without success, or for a free floor that is not closed off.
  localise::Pose2D draw(std::uint64_t seed, std::uint32_t trial) const;

  /// Density of the queries at a pose, up to a factor: the number of straight parts of the route
  /// from which it may be drawn; on the free floor 1 or 0.
  double density(const localise::Pose2D& pose) const;

 private:
  bool is_free_at(const localise::Pose2D& pose) const;
  bool is_seen_from(const Eigen::Vector2d& on_route_m, const localise::Pose2D& pose) const;

  const Visibility& visibility_;
  QueryProtocol protocol_;
  double eye_height_m_;
  std::unique_ptr<const vernier::sim::internal::FreeFloor> floor_;  // of QueryProtocol::free
};

/// QueryPlaces::draw, for a single query.
localise::Pose2D draw_query(const Visibility& visibility,
                            QueryProtocol protocol,
                            double eye_height_m,
                            std::uint64_t seed,
                            std::uint32_t trial);

/// Which rig is assumed when the map is recorded.
enum class MapRig {
  recalibrated,  ///< an independent draw, one per block
  same,          ///< the draw of the query
};

struct ExperimentSettings {
  SourceSettings sources;
  localise::CameraMount mount;
  QueryProtocol protocol = QueryProtocol::path;
  MapRig map_rig = MapRig::recalibrated;
  double map_spacing_m = 0.5;
  int map_headings = 0;  ///< per node; 0: along the route
  std::string method = "lines";
  /// Views hold corners if the method needs them (localise::needs_corners); other methods' results
  /// and draws are the same with and without.
  localise::LocaliserOptions localiser;
  AppearanceOptions appearance{.view_change = 1, .noise = 0.3};  ///< of corners
  /// Views of a query at most, from one position: another one is taken as long as the localiser
  /// asks for it (next_turn_rad), and away from those taken where it does not answer and asks for
  /// none.
  int looks = 1;
  bool knows_endpoint_sigma = false;  ///< the estimator assumes sources.endpoint_sigma_px
  std::uint64_t seed = 1;
};

/// An answer of a localiser is right within this distance on the floor.
inline constexpr double success_radius_m = 1;

/// One trial of a system under test: a localiser here, and what else a study tries
/// (docs/systems.md), which has an error in a unit of its own, `measured`, and nothing of what is
/// said below of maps, nodes and looks.
struct TrialResult {
  std::uint32_t trial = 0;
  localise::Pose2D truth;  ///< pose of the query, or of the robot at its start
  localise::LocalisationStatus status = localise::LocalisationStatus::too_few_lines;
  localise::Pose2D answer;  ///< refined pose
  localise::Pose2D node;    ///< the map's node, or the answer of a localiser that names none
  /// Of a localiser the distance between answer and truth on the floor, metres; NaN without an
  /// answer. An unsure localiser's best guess counts as an answer here, but not in answered().
  double error = 0;
  double limit = success_radius_m;  ///< an answer is right if its error is at most this
  double node_error_m = 0;
  double heading_error_rad = 0;
  int lines = 0;              ///< in space, of the first look, as given to the localiser
  int looks = 1;              ///< views that were taken
  int corners = 0;            ///< corner pairs sensed (for corner-based methods)
  int corner_mismatches = 0;  ///< number of them with a wrong partner
  double score = 0, runner_up = 0;
  double probability = 0;          ///< that the answer is right, as the localiser states it
  double cpu_ms = 0, wall_ms = 0;  ///< from features in memory to the answer
  /// What another system measures, in the order of its names; none of a localiser's.
  std::optional<std::vector<double>> measured = {};
  /// Why the system or a source failed, or doubts its answer; studies do not store a localiser's.
  std::string failure;

  bool answered() const { return status == localise::LocalisationStatus::answered; }
  bool success() const { return answered() && error <= limit; }
};

/// Trials that share a recorded map: first, first + 1 …
struct TrialBlock {
  std::uint32_t block = 0;  ///< which map
  std::uint32_t first = 0;
  std::uint32_t count = 1;
};

/// Noise-free views from the map's nodes. They depend only on world, true rig and mount, so blocks
/// and cells that differ in noise share them.
using MapViews = std::vector<NoiseFreeView>;
MapViews map_views(const Visibility& visibility,
                   const Rig& true_rig,
                   const ExperimentSettings& settings);

/// The views from a true mount that is not the told one (draw_mount).
MapViews map_views(const Visibility& visibility,
                   const Rig& true_rig,
                   const ExperimentSettings& settings,
                   const TrueMount& stands);

/// A simulated robot that records a map with one calibration of its rig and localises with another.
/// The estimate is the true rig, which makes all images; the rigs assumed by the estimator are
/// drawn around it, or told by `told`.
class LocalisationExperiment {
 public:
  /// Keeps a reference to `visibility`; `looks` is needed for maps and blocks only. Throws Error
  /// for settings out of range, or a rig without covariance if sources.calibration > 0 and nothing
  /// is `told` (which then scales by psi_c itself). `changed`
  /// is the world as queries find it if furniture has moved (sources.moved), `places` those of the
  /// settings' protocol and height in that world; without, it makes its own. The map is recorded in
  /// the world of `visibility`.
  LocalisationExperiment(const Visibility& visibility,
                         const RigEstimate& rig,
                         std::shared_ptr<const MapViews> looks,
                         ExperimentSettings settings,
                         std::shared_ptr<const QueryPlaces> places = nullptr,
                         std::shared_ptr<const ChangedWorld> changed = nullptr,
                         std::shared_ptr<const ToldRigs> told = nullptr);

  /// Runs the trials of one block: the map is recorded once, with draws of its own. With
  /// MapRig::same the map is recorded again for every trial. Results depend on (settings, block,
  /// trial) only. A trial without a told rig of its own, or of the map, has failed. Throws Error
  /// without `looks`.
  std::vector<TrialResult> run_block(const TrialBlock& block) const;

  /// One trial with a localiser of one's own or of make_localiser(), whose map record_map() made.
  /// It has failed where the localiser throws what is no Error, states a probability beyond [0, 1],
  /// or answers with numbers that are not finite.
  TrialResult run_trial(std::uint32_t trial,
                        const Rig& told,
                        const localise::TopologicalMap& map,
                        const localise::Localiser& localiser) const;

  /// The map as recorded in a block under the assumption of `rig`. Throws Error if a source of
  /// one's own fails.
  localise::TopologicalMap record_map(std::uint32_t block, const Rig& rig) const;

  /// The rig assumed by the estimator in a trial. Throws Error if it has none.
  Rig estimator_rig(std::uint32_t trial) const;
  Rig map_estimator_rig(std::uint32_t block) const;

 private:
  /// The first failure of a source, if there is one, is told in `failure`; the map is then a part.
  localise::TopologicalMap record(std::uint32_t block,
                                  const Rig& rig,
                                  const MapViews& views,
                                  std::string& failure) const;
  /// What the map's drive of a block sees, by a camera that stands as it does in this block.
  std::shared_ptr<const MapViews> views_of(std::uint32_t block) const;
  localise::Pose2D place_of(std::uint32_t trial) const;
  /// Of the trial, or of the map of block draw - 2³¹.
  ToldRig told_rig(std::uint32_t draw) const;
  TrialResult spoilt_trial(std::uint32_t trial, std::string failure) const;
  std::vector<localise::StereoCorner> described(const StereoObservation& sighting,
                                                const localise::Pose2D& pose,
                                                const SensingDraw& draw,
                                                const CornerAppearance* appearance) const;

  const Visibility& visibility_;                 // of the recorded world
  std::shared_ptr<const ChangedWorld> changed_;  // null if nothing has moved
  const Visibility& queried_;                    // of the world that queries see
  Rig truth_;
  std::shared_ptr<const ToldRigs> told_;  // null without calibration error
  std::shared_ptr<const MapViews> map_views_;
  std::shared_ptr<const QueryPlaces> places_;
  ExperimentSettings settings_;
  Sensor sensor_;
  std::unique_ptr<CornerAppearance> appearance_;          // null if views hold no corners
  std::unique_ptr<CornerAppearance> changed_appearance_;  // in the changed world, if there is one
};

}  // namespace vernier::sim
