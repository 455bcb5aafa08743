// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

/// Visual servoing (sim/visual_servo.h) as a system under test: a trial drives to stand in front of
/// a door, and its error is the distance from where it should stand. A drive that runs out of time
/// is an unsure answer; one that loses the door has none.
SystemKind servo_kind();

}  // namespace vernier::sim::internal
