// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/built_in_matchers.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "stereo/edge_matcher.h"
#include "stereo/matcher.h"
#include "stereo/matching/dense_matchers.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

const std::vector<std::string>& built_in_matchers() {
  static const std::vector<std::string> names{"edge", "stretch", "bm", "sgbm"};
  return names;
}

Matcher built_in_matcher(const std::string& name) {
  if (name == "edge") return edge_matcher();
  if (name == "stretch") return stretch_matcher();
  if (name == "bm") return bm();
  if (name == "sgbm") return sgbm();
  throw std::out_of_range("no matcher " + name);
}

}  // namespace vernier::stereo::internal
