// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place/space_lines.h"

#include "localise/place.h"

namespace vernier::localise::internal {

void SpaceLines::add(const Eigen::Vector3f& a_m,
                     const Eigen::Vector3f& b_m,
                     float sigma,
                     bool is_counted) {
  for (auto* column : {&ax, &ay, &az, &bx, &by, &bz, &sigma_m, &counted}) column->resize(size);
  ax.push_back(a_m.x());
  ay.push_back(a_m.y());
  az.push_back(a_m.z());
  bx.push_back(b_m.x());
  by.push_back(b_m.y());
  bz.push_back(b_m.z());
  sigma_m.push_back(sigma);
  counted.push_back(is_counted ? 1.0f : 0.0f);
  ++size;
}

void SpaceLines::pad() {
  constexpr std::size_t lanes = 16;  // of the widest instruction set
  const std::size_t padded = (size + lanes - 1) / lanes * lanes;
  for (auto* column : {&ax, &ay, &az, &bx, &by, &bz, &sigma_m, &counted}) {
    column->resize(padded, column == &ax || column == &bx ? -1e6f : 0.0f);
  }
}

SpaceLines space_lines(std::span<const PlaceLine> lines) {
  SpaceLines columns;
  for (const PlaceLine& line : lines) {
    columns.add(line.a_m.cast<float>(), line.b_m.cast<float>(), static_cast<float>(line.sigma_m),
                true);
  }
  columns.pad();
  return columns;
}

}  // namespace vernier::localise::internal
