// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::sim {

/// Numeric options of a source by name.
using SourceOptions = std::map<std::string, double>;

/// A source of one's own: the name it was registered with (register_source), and its options.
struct OwnSource {
  std::string name;
  SourceOptions options;
};

/// Whether an edge is displaced alike in both cameras.
enum class ShiftMode { common, independent };

/// Magnitudes of the sources of geometric error. Defaults and ranges: Tina Memo 2017-001;
/// definitions: docs/simulation.md. A value of 0 disables a source.
struct SourceSettings {
  double moved = 0;             ///< share of the furniture moved since the map was recorded
  double mount_height_m = 0;    ///< standard deviation of the camera's height from what is told
  double mount_pitch_deg = 0;   ///< of its pitch
  double mount_roll_deg = 0;    ///< of its roll, which is told to be 0
  double unseen = 0;            ///< share of the world's edges that no image shows
  double missed = 0;            ///< share of the edges in view that the view misses whole
  double missed_alike = 0;      ///< correlation of what views at one place miss
  double missed_alike_m = 1;    ///< side of the places that miss alike
  double clutter = 0;           ///< false edges, as a fraction of the edges in view
  double lateral_shift_px = 3;  ///< psi_l: |shift| ~ U[s/2, 3s/2] along the image normal
  ShiftMode lateral_shift_mode = ShiftMode::common;
  double merge_px = 0;              ///< parallel lines nearer than this are detected as one
  double edge_loss = 0.1125;        ///< psi_e: fraction of each edge's length that is missing
  double endpoint_sigma_px = 0.15;  ///< psi_g: isotropic, of every end in each camera
  double epipolar_reject_deg = 5;   ///< edges nearer than this to their epipolar line are dropped
  double stereo_mismatch = 0.01;    ///< psi_s: fraction of edges with a wrong partner
  double stereo_mismatch_px = 20;   ///< displacement along the epipolar line: U[-d, d]
  double corner_loss = 0.15;        ///< psi_cd: fraction of corner pairs lost
  double corner_sigma_px = 0.15;    ///< psi_g of corners: isotropic, in each camera
  double corner_mismatch = 0.01;    ///< psi_cm: fraction of corner pairs with a wrong partner
  double corner_mismatch_px = 10;   ///< displacement: uniform in a disc of this radius
  /// Psi_c: factor on the standard deviations of the calibration covariance.
  double calibration = 1;
  /// Sources of one's own, after all others and in this order (docs/own-source.md).
  std::vector<OwnSource> own;
  /// A source that is a program, after these: it and its arguments, quoted as in a shell.
  std::string command;
  double time_limit_s = 10;  ///< of the program, for a view; above 0
};

/// What of a view a source changes.
enum class SourceTarget { view, edges, corners };

/// One setting, with its name in study files.
struct SourceParameter {
  std::string_view name;
  double SourceSettings::*value;
  double low, high;  ///< accepted, inclusive
  bool is_switch;    ///< 0 disables a source; false: a magnitude used when a source is enabled
  SourceTarget acts_on;
  std::string_view about;
  /// Results are stored under keys that leave it out while it has its default: stores older than
  /// the setting stay valid.
  bool is_newer = false;
  /// Of a magnitude: the setting without which, at 0, it has no effect.
  std::string_view only_with = {};
};

/// All numeric settings, in the order in which the sources act.
std::span<const SourceParameter> source_parameters();

/// The one of that name; null if there is none.
const SourceParameter* source_parameter(std::string_view name);

/// The setting that is 0 and without which a magnitude has no effect; null if there is none.
const SourceParameter* switched_off_with(const SourceParameter& magnitude,
                                         const SourceSettings& settings);

/// Throws Error naming the setting for a value out of range, and a command that is none.
void check(const SourceSettings& settings, const std::string& place);

/// All sources disabled; magnitudes keep their defaults.
SourceSettings no_sources();

}  // namespace vernier::sim
