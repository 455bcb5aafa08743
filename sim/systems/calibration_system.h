// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

/// Calibration as a system under test: a trial calibrates the true rig from board views of its own,
/// as [calibration] says, and its error is that of the depth of a point on the left axis at
/// `range_m`. A doubtful calibration is an unsure answer, one that throws has failed.
SystemKind calibration_kind();

}  // namespace vernier::sim::internal
