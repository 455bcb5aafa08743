// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

namespace vernier::test {

/// A spiral of two arms, as one face: half of its corners are concave.
inline std::string spiral_ply(int corners) {
  const std::string count = std::to_string(corners);
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + count +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                     "property list int int vertex_indices\nend_header\n";
  for (int i = 0; i < corners; ++i) {
    const bool is_back = i >= corners / 2;
    const double turn = 0.05 * (is_back ? corners - 1 - i : i);
    const double radius = 1 + 0.1 * turn - (is_back ? 0.05 : 0);
    text += std::to_string(radius * std::cos(turn)) + " " +
            std::to_string(radius * std::sin(turn)) + " 0\n";
  }
  text += count;
  for (int i = 0; i < corners; ++i) text += " " + std::to_string(i);
  return text + "\n";
}

}  // namespace vernier::test
