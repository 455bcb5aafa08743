// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_noise.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/noise/camera_scales.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/validation/held_out_boards.h"
#include "cli/calibration/check_section.h"
#include "cli/calibration/component_test.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

Json motion_json(const FrameMotion& motion, const Rig& rig) {
  const auto& u = motion.predicted;
  return {{"frame", motion.frame},
          {"camera", rig.cameras[static_cast<std::size_t>(motion.camera)].name},
          {"rotation_rad", {u[0], u[1], u[2]}},
          {"translation_m", {u[3], u[4], u[5]}},
          {"chi2", motion.chi2}};
}

Json noise_json(const CornerNoiseEstimate& found, const Rig& rig) {
  const CornerNoise& noise = found.fit.noise;
  Json json{{"white_px", noise.white_px},
            {"field_px", noise.field_px},
            {"field_length_m", noise.field_length_m},
            {"field_test", test_json(found.field)},
            {"motion_rad", nullptr},
            {"motion_m", nullptr},
            {"motion_baseline_m", nullptr},
            {"motion_test", test_json(found.motion)},
            {"isotropy_test", test_json(found.isotropy)},
            {"converged", found.fit.converged},
            {"motions", Json::array()},
            {"moved", Json::array()}};
  if (!found.motion) return json;
  json["motion_rad"] = noise.motion_rad;
  json["motion_m"] = noise.motion_m;
  if (found.is_along_baseline()) json["motion_baseline_m"] = noise.motion_baseline_m;
  for (const FrameMotion& m : found.fit.solution.motions)
    json["motions"].push_back(motion_json(m, rig));
  for (const FrameMotion& m : found.moved()) {
    if (json["moved"].empty() || json["moved"].back() != m.frame) json["moved"].push_back(m.frame);
  }
  return json;
}

std::string noise_text(const CornerNoiseEstimate& found, const Rig& rig) {
  const CornerNoise& noise = found.fit.noise;
  std::string text = fmt::format(
      "corner noise by components: {:.3f} px white\n"
      "  {:.3f} px smooth over {:.0f} mm of the board ({})\n",
      noise.white_px, noise.field_px, 1e3 * noise.field_length_m, p_text(found.field->p_value));
  if (!found.motion) return text;
  if (!(found.motion->ratio > 0)) {
    return text + fmt::format("  no motion of the board between exposures ({})\n",
                              p_text(found.motion->p_value));
  }
  text += fmt::format(
      "  {} and {:.2f} mrad, each axis, of motion of the board between exposures ({})\n",
      motion_words(noise.motion_m, noise.motion_baseline_m), 1e3 * noise.motion_rad,
      p_text(found.motion->p_value));
  for (const FrameMotion& m : found.moved()) {
    text += fmt::format(
        "  the board moved {:.1f} mm and turned {:.1f} mrad between the exposures of frame {}{}\n",
        1e3 * m.predicted.tail<3>().norm(), 1e3 * m.predicted.head<3>().norm(), m.frame,
        rig.cameras.size() > 2 ? ", camera " + rig.cameras[static_cast<std::size_t>(m.camera)].name
                               : "");
  }
  return text;
}

}  // namespace

CheckSection check_corner_noise(const RigEstimate& estimate,
                                BoardStand stand,
                                const Session& session) {
  session.info("estimating the components of the corner noise");
  const CornerNoiseEstimate found = estimate_corner_noise(
      estimate, {.motion = stand == BoardStand::hand_held, .baseline_motion = true},
      {.shape = true}, CameraNoise::of_each);
  CheckSection part;
  part.json = noise_json(found, estimate.rig);
  part.text = noise_text(found, estimate.rig);
  if (!found.fit.converged) {
    part.failures.push_back(
        "the components of the corner noise were not found: their likelihood has no clear maximum; "
        "give more views");
  }
  return part;
}

}  // namespace vernier::cli
