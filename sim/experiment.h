// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"

namespace vernier::sim {

/// How far from the recorded route queries are asked. Worth more than any other setting, so it is
/// part of every result.
enum class QueryProtocol {
  near_path,  ///< ± 0.1 m across the route, ± 5°
  path,       ///< ± 0.3 m, ± 15°
  anywhere,   ///< ± 0.6 m, any heading
};

std::string_view name(QueryProtocol protocol);
/// Throws Error for a name that is none of near_path, path, anywhere.
QueryProtocol query_protocol(std::string_view name);

/// Where trial `trial` asks: uniform along the route, across it and in heading; drawn again (from
/// the same stream) where a robot of 0.12 m radius could not stand or a surface parts the place
/// from the route. Throws Error where 1000 draws find no place.
localise::Pose2D draw_query(const Visibility& visibility,
                            QueryProtocol protocol,
                            double eye_height_m,
                            std::uint64_t seed,
                            std::uint32_t trial);

/// Which rig the map's recorder was told.
enum class MapRig {
  recalibrated,  ///< a draw of its own, once a block
  same,          ///< the draw of the query
};

struct ExperimentSettings {
  SourceSettings sources;
  localise::CameraMount mount;
  QueryProtocol protocol = QueryProtocol::path;
  MapRig map_rig = MapRig::recalibrated;
  double map_spacing_m = 0.5;
  int map_headings = 0;  ///< a node; 0: along the route
  std::string method = "pgh";
  bool knows_endpoint_sigma = false;  ///< the estimator is told sources.endpoint_sigma_px
  std::uint64_t seed = 1;
};

/// One localisation trial: where the robot was, what was answered, and what that cost.
struct TrialResult {
  std::uint32_t trial = 0;
  localise::Pose2D truth;
  localise::LocalisationStatus status = localise::LocalisationStatus::too_few_lines;
  localise::Pose2D answer;  ///< refined pose
  localise::Pose2D node;    ///< the map's node
  double error_m = 0;       ///< of the answer on the floor; NaN without one
  double node_error_m = 0;
  double heading_error_rad = 0;
  int lines = 0;              ///< in space, as the localiser had them
  int corners = 0;            ///< corner pairs sensed (for corner-based methods)
  int corner_mismatches = 0;  ///< of them with a wrong partner
  double score = 0, runner_up = 0;
  double cpu_ms = 0, wall_ms = 0;  ///< from features in memory to the answer

  bool answered() const { return status == localise::LocalisationStatus::answered; }
  bool success() const { return answered() && error_m <= 1.0; }
};

/// Trials that share a recorded map: first, first + 1 …
struct TrialBlock {
  std::uint32_t block = 0;  ///< which map
  std::uint32_t first = 0;
  std::uint32_t count = 1;
};

/// The noise-free looks of a map's places: they depend on world, true rig and mount alone, so
/// blocks and cells that differ in noise share them.
using MapViews = std::vector<NoiseFreeView>;
MapViews map_views(const Visibility& visibility,
                   const Rig& true_rig,
                   const ExperimentSettings& settings);

/// A simulated robot that records a map with one calibration of its rig and localises with
/// another. The true rig is the estimate's; what an estimator is told is drawn around it.
class LocalisationExperiment {
 public:
  /// Keeps a reference to `visibility`; `looks` is needed for maps and blocks only. Throws Error
  /// for bad settings or a rig without covariance where sources.calibration > 0.
  LocalisationExperiment(const Visibility& visibility,
                         const RigEstimate& rig,
                         std::shared_ptr<const MapViews> looks,
                         ExperimentSettings settings);

  /// The trials of one block: the map is recorded once, with draws of the
  /// block's own. With MapRig::same the map is recorded again for every trial. Results depend on
  /// (settings, block, trial) only.
  std::vector<TrialResult> run_block(const TrialBlock& block) const;

  /// The map as recorded in a block, told `rig`.
  localise::TopologicalMap record_map(std::uint32_t block, const Rig& rig) const;

  /// What the estimator of a trial is told.
  Rig estimator_rig(std::uint32_t trial) const;
  Rig map_estimator_rig(std::uint32_t block) const;

 private:
  TrialResult run_trial(std::uint32_t trial,
                        const Rig& told,
                        const localise::Localiser& localiser) const;
  Rig draw_rig(std::uint32_t trial, bool of_map) const;

  const Visibility& visibility_;
  RigEstimate rig_;
  std::shared_ptr<const MapViews> map_views_;
  ExperimentSettings settings_;
  Sensor sensor_;
  std::unique_ptr<RigSampler> sampler_;  // none where calibration error is off
};

}  // namespace vernier::sim
