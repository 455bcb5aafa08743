// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/block_outcomes.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "calib/base/fingerprint.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

BlockOutcomes outcomes_of(std::span<const TrialResult> block) {
  BlockOutcomes outcomes;
  if (block.empty()) return outcomes;
  outcomes.first = block.front().trial;
  std::string poses;
  for (std::size_t i = 0; i < block.size(); ++i) {
    const TrialResult& t = block[i];
    if (t.trial != outcomes.first + i) throw std::logic_error("a block has a gap");
    const std::array<double, 3> pose{t.truth.x_m, t.truth.y_m, t.truth.heading_rad};
    poses.append(reinterpret_cast<const char*>(pose.data()), sizeof pose);
    outcomes.succeeded.push_back(t.success());
  }
  outcomes.queries = vernier::internal::fingerprint(poses);
  return outcomes;
}

}  // namespace vernier::sim::internal
