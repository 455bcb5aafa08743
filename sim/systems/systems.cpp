// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/systems/systems.h"

#include "sim/study/system_kind.h"
#include "sim/systems/calibration_system.h"
#include "sim/systems/program_system.h"
#include "sim/systems/servo_system.h"

namespace vernier::sim::internal {

void register_systems() {
  register_system(calibration_kind());
  register_system(program_kind());
  register_system(servo_kind());
}

}  // namespace vernier::sim::internal
