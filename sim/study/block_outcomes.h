// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// What a comparison of two cells needs of a block.
struct BlockOutcomes {
  std::uint32_t first = 0;      ///< number of its first trial; the others follow
  std::string queries;          ///< fingerprint of the true poses
  std::vector<bool> succeeded;  ///< by trial
};

/// Of trials with ascending numbers, without gaps. Throws std::logic_error if there is one.
BlockOutcomes outcomes_of(std::span<const TrialResult> block);

}  // namespace vernier::sim::internal
