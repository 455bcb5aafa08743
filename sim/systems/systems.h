// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vernier::sim::internal {

/// Makes calibration, servoing and programs known to studies (register_system).
void register_systems();

}  // namespace vernier::sim::internal
