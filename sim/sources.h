// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vernier::sim {

/// Whether an edge is displaced alike in both cameras.
enum class ShiftMode { common, independent };

/// Magnitudes of the sources of geometric error. Defaults and ranges: Tina Memo 2017-001;
/// definitions: docs/simulation.md. A value of 0 disables a source.
struct SourceSettings {
  double lateral_shift_px = 3;  ///< psi_l: |shift| ~ U[s/2, 3s/2] along the image normal
  ShiftMode lateral_shift_mode = ShiftMode::common;
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
};

/// One setting, with its name in study files.
struct SourceParameter {
  std::string_view name;
  double SourceSettings::*value;
  double low, high;  ///< accepted, inclusive
  bool is_switch;    ///< 0 disables a source; false: a magnitude used when a source is enabled
  std::string_view about;
};

/// All numeric settings, in the order in which the sources act.
std::span<const SourceParameter> source_parameters();

/// Throws Error naming the setting for a value out of range.
void check(const SourceSettings& settings, const std::string& place);

/// All sources disabled; magnitudes keep their defaults.
SourceSettings no_sources();

}  // namespace vernier::sim
