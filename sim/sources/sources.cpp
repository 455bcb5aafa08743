// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "calib/base/program_run.h"
#include "calib/error.h"

namespace vernier::sim {
namespace {

constexpr SourceParameter parameters[] = {
    {"moved", &SourceSettings::moved, 0, 1, true, SourceTarget::view,
     "share of the furniture moved since the map was recorded", true},
    {"mount_height_m", &SourceSettings::mount_height_m, 0, 1, true, SourceTarget::view,
     "standard deviation of the camera's height from what is told", true},
    {"mount_pitch_deg", &SourceSettings::mount_pitch_deg, 0, 30, true, SourceTarget::view,
     "standard deviation of the camera's pitch from what is told", true},
    {"mount_roll_deg", &SourceSettings::mount_roll_deg, 0, 30, true, SourceTarget::view,
     "standard deviation of the camera's roll, which is told to be 0", true},
    {"unseen", &SourceSettings::unseen, 0, 1, true, SourceTarget::edges,
     "share of the world's edges that no image shows", true},
    {"missed", &SourceSettings::missed, 0, 1, true, SourceTarget::edges,
     "share of the edges in view that the view misses whole", true},
    {"missed_alike", &SourceSettings::missed_alike, 0, 1, false, SourceTarget::edges,
     "correlation of what two views at one place miss", true, "missed"},
    {"missed_alike_m", &SourceSettings::missed_alike_m, 0.05, 1000, false, SourceTarget::edges,
     "side of the places whose views miss alike", true, "missed_alike"},
    {"clutter", &SourceSettings::clutter, 0, 5, true, SourceTarget::edges,
     "false edges in a view, as a fraction of its edges", true},
    {"lateral_shift_px", &SourceSettings::lateral_shift_px, 0, 100, true, SourceTarget::edges,
     "psi_l: illumination displaces an edge by U[s/2, 3s/2] pixels"},
    {"merge_px", &SourceSettings::merge_px, 0, 100, true, SourceTarget::edges,
     "parallel lines nearer than this are detected as one", true},
    {"edge_loss", &SourceSettings::edge_loss, 0, 0.95, true, SourceTarget::edges,
     "psi_e: fraction of each edge's length lost in one gap"},
    {"endpoint_sigma_px", &SourceSettings::endpoint_sigma_px, 0, 10, true, SourceTarget::edges,
     "psi_g: Gaussian error of each end point"},
    {"epipolar_reject_deg", &SourceSettings::epipolar_reject_deg, 0, 89, true, SourceTarget::edges,
     "edges within this angle of the epipolar direction are dropped"},
    {"stereo_mismatch", &SourceSettings::stereo_mismatch, 0, 1, true, SourceTarget::edges,
     "psi_s: fraction of edges matched wrongly"},
    {"stereo_mismatch_px", &SourceSettings::stereo_mismatch_px, 0, 500, false, SourceTarget::edges,
     "maximum displacement of a wrong match along the epipolar line", false, "stereo_mismatch"},
    {"corner_loss", &SourceSettings::corner_loss, 0, 1, true, SourceTarget::corners,
     "psi_cd: fraction of corner pairs lost"},
    {"corner_sigma_px", &SourceSettings::corner_sigma_px, 0, 10, true, SourceTarget::corners,
     "psi_g: Gaussian error of each corner"},
    {"corner_mismatch", &SourceSettings::corner_mismatch, 0, 1, true, SourceTarget::corners,
     "psi_cm: fraction of corner pairs matched wrongly"},
    {"corner_mismatch_px", &SourceSettings::corner_mismatch_px, 0, 500, false,
     SourceTarget::corners, "maximum displacement of a wrong corner match", false,
     "corner_mismatch"},
    {"calibration", &SourceSettings::calibration, 0, 1000, true, SourceTarget::view,
     "psi_c: factor on the standard deviations of the calibration"},
};

}  // namespace

std::span<const SourceParameter> source_parameters() { return parameters; }

const SourceParameter* source_parameter(std::string_view name) {
  const auto* found = std::find_if(std::begin(parameters), std::end(parameters),
                                   [&](const SourceParameter& one) { return one.name == name; });
  return found == std::end(parameters) ? nullptr : found;
}

const SourceParameter* switched_off_with(const SourceParameter& magnitude,
                                         const SourceSettings& settings) {
  if (magnitude.only_with.empty()) return nullptr;
  const SourceParameter* with = source_parameter(magnitude.only_with);
  return settings.*with->value == 0 ? with : switched_off_with(*with, settings);
}

void check(const SourceSettings& settings, const std::string& place) {
  for (const SourceParameter& parameter : parameters) {
    const double value = settings.*parameter.value;
    if (!(value >= parameter.low && value <= parameter.high)) {
      throw Error(place, fmt::format("sources.{} = {} is out of range", parameter.name, value),
                  fmt::format("use {} to {}", parameter.low, parameter.high));
    }
  }
  if (settings.command.empty()) return;
  if (!(settings.time_limit_s > 0 && settings.time_limit_s <= 1e6)) {
    throw Error(place, "sources.time_limit_s is not above 0 and at most 1e6", "use 10 seconds");
  }
  if (vernier::internal::command_words(settings.command, place + ": sources.command").empty()) {
    throw Error(place, "sources.command is blank", "name the program, or leave it out");
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
