// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

/// A stereo matcher as a system under test: a trial renders the pair that the true rig sees from a
/// query's pose, with noise of its own, and scores the matcher at the edges of the left image
/// against the true disparities (stereo/matcher_evaluation.h). Its error is the share of these
/// edges that have no disparity within 1 px of the truth.
SystemKind matcher_kind();

}  // namespace vernier::sim::internal
