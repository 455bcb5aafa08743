// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/namespaces.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// The shard given as "i/n", or else by the variables of a Slurm array (SLURM_ARRAY_TASK_ID, _MIN,
/// _MAX, _STEP, _COUNT); without both, the whole study. Throws Error if the text or a variable is
/// no whole number in its range, or if the array has gaps other than its step: a shard taken
/// wrongly would leave blocks out.
Shard shard_choice(const std::string& text);

}  // namespace vernier::cli
