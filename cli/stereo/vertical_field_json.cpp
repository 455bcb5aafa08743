// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/vertical_field_json.h"

#include <string>

#include "cli/program/session.h"
#include "stereo/rectification/vertical_field.h"

namespace vernier::cli {

Json vertical_field_json(const VerticalField& field, bool repaired) {
  const Eigen::Vector3d sd = field.covariance_px2.diagonal().cwiseSqrt();
  const auto triple = [](const Eigen::Vector3d& v) { return Json{v[0], v[1], v[2]}; };
  return {{"coefficients_px", field.known ? triple(field.coefficients_px) : Json()},
          {"sigma_px", field.known ? triple(sd) : Json()},
          {"residual_px", field.known ? Json(field.residual_px) : Json()},
          {"corners", field.corners},
          {"matched", field.matched},
          {"used", field.used},
          {"known", field.known},
          {"rms_px", field.known ? Json(field.rms_px()) : Json()},
          {"significant", field.significant},
          {"misaligned", field.misaligned},
          {"unrectified", field.unrectified},
          {"words", describe(field)},
          {"repaired", repaired}};
}

std::string misalignment(const VerticalField& field) {
  return fmt::format(
      "the rows of the two images are misaligned by {:.2f} px rms, more than the {:.1f} px up to "
      "which matches are as good as stated: {}; ",
      field.rms_px(), VerticalFieldOptions{}.max_rms_px, describe(field));
}

}  // namespace vernier::cli
