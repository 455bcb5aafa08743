// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/row_doubt.h"

#include <fmt/format.h>

#include "stereo/rectification/vertical_field.h"

namespace vernier::cli {

std::string row_doubt(const VerticalField& field) {
  constexpr double most_px = 0.5;
  const double rms_px = field.rms_px();
  if (field.unrectified || !field.significant || rms_px <= most_px) return "";
  return fmt::format(
      "the rows are misaligned by {:.2f} px (rms over the image), so that disparities are wrong by "
      "more than stated: --repair corrects the images",
      rms_px);
}

}  // namespace vernier::cli
