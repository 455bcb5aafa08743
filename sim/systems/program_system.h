// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/base/json_node.h"
#include "sim/experiment.h"
#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

/// A user's program as a system under test: it is told, in lines of JSON, what the cell's
/// [parameters] are and, for each trial, its number, the true rig and the one that is told
/// (docs/systems.md); it answers with its error.
SystemKind program_kind();

/// Reads an answer into a trial that has not got one. Throws Error for what is not one.
void parse_system_answer(const vernier::internal::JsonNode& answer,
                         const SystemSettings& system,
                         TrialResult& trial);

}  // namespace vernier::sim::internal
