// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/vertical_field_json.h"

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
          {"significant", field.significant},
          {"unrectified", field.unrectified},
          {"words", describe(field)},
          {"repaired", repaired}};
}

}  // namespace vernier::cli
