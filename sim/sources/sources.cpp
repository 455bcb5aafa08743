// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources.h"

#include <fmt/format.h>

#include "calib/error.h"

namespace vernier::sim {
namespace {

constexpr SourceParameter parameters[] = {
    {"lateral_shift_px", &SourceSettings::lateral_shift_px, 0, 100, true,
     "psi_l: illumination moves an edge by U[s/2, 3s/2] pixels"},
    {"edge_loss", &SourceSettings::edge_loss, 0, 0.95, true,
     "psi_e: share of each edge's length in one gap"},
    {"endpoint_sigma_px", &SourceSettings::endpoint_sigma_px, 0, 10, true,
     "psi_g: Gaussian error of each end point"},
    {"epipolar_reject_deg", &SourceSettings::epipolar_reject_deg, 0, 89, true,
     "edges this near to the epipolar direction are dropped"},
    {"stereo_mismatch", &SourceSettings::stereo_mismatch, 0, 1, true,
     "psi_s: share of edges matched wrongly"},
    {"stereo_mismatch_px", &SourceSettings::stereo_mismatch_px, 0, 500, false,
     "reach of a wrong match along the epipolar line"},
    {"corner_loss", &SourceSettings::corner_loss, 0, 1, true, "psi_cd: share of corner pairs lost"},
    {"corner_mismatch", &SourceSettings::corner_mismatch, 0, 1, true,
     "psi_cm: share of corner pairs matched wrongly"},
    {"corner_mismatch_px", &SourceSettings::corner_mismatch_px, 0, 500, false,
     "radius in which a wrong corner match lies"},
    {"calibration", &SourceSettings::calibration, 0, 1000, true,
     "psi_c: factor on the calibration's standard deviations"},
};

}  // namespace

std::span<const SourceParameter> source_parameters() { return parameters; }

void check(const SourceSettings& settings, const std::string& place) {
  for (const SourceParameter& parameter : parameters) {
    const double value = settings.*parameter.value;
    if (!(value >= parameter.low && value <= parameter.high)) {
      throw Error(place, fmt::format("sources.{} = {} is out of range", parameter.name, value),
                  fmt::format("give {} to {}", parameter.low, parameter.high));
    }
  }
}

SourceSettings no_sources() {
  SourceSettings settings;
  for (const SourceParameter& parameter : parameters) {
    if (parameter.is_switch) settings.*parameter.value = 0;
  }
  return settings;
}

}  // namespace vernier::sim
