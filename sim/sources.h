// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vernier::sim {

/// Whether both eyes see an edge's boundary displaced alike.
enum class ShiftMode { common, independent };

/// How much each known source of geometric error does. Defaults and ranges: Tina Memo 2017-001;
/// semantics: docs/simulation.md. A value of 0 turns a source off.
struct SourceSettings {
  double lateral_shift_px = 3;  ///< psi_l: |shift| ~ U[s/2, 3s/2] along the image normal
  ShiftMode lateral_shift_mode = ShiftMode::common;
  double edge_loss = 0.1125;        ///< psi_e: share of each edge's length that is missing
  double endpoint_sigma_px = 0.15;  ///< psi_g: isotropic, of every end in every eye
  double epipolar_reject_deg = 5;   ///< edges nearer than this to their epipolar line are dropped
  double stereo_mismatch = 0.01;    ///< psi_s: share of edges with a wrong partner
  double stereo_mismatch_px = 20;   ///< and how far off along the epipolar line: U[-d, d]
  double corner_loss = 0.15;        ///< psi_cd: share of corner pairs not found again
  double corner_mismatch = 0.01;    ///< psi_cm: share of corner pairs with a wrong partner
  double corner_mismatch_px = 10;   ///< anywhere in a disc of this radius
  double calibration = 1;           ///< psi_c: times the calibrated covariance's deviations
};

/// One setting by its name in study files.
struct SourceParameter {
  std::string_view name;
  double SourceSettings::*value;
  double low, high;  ///< accepted, inclusive
  bool is_switch;    ///< 0 turns a source off; else it says how far one reaches
  std::string_view about;
};

/// All numeric settings, in the order in which they act.
std::span<const SourceParameter> source_parameters();

/// Throws Error, naming the setting, for a value outside its accepted range.
void check(const SourceSettings& settings, const std::string& place);

/// Every source off; how far they reach when on stays at its default.
SourceSettings no_sources();

}  // namespace vernier::sim
