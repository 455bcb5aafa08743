// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/study/study.h"

namespace vernier::sim::internal {

/// Why the results of `stored` are not results of `wanted`, in words that name the settings with
/// both values: the world, the rig, a cell that `wanted` does not have, or fewer trials. Empty if
/// there is no reason: both are the same, or `wanted` has more trials or cells. Only what
/// determines results counts, not the layout of the files.
std::string study_difference(const Study& stored, const Study& wanted);

/// What counts as a success there and not here, in words; empty: the same in all cells. It decides
/// nothing about whether stored trials are wanted.
std::string limit_difference(const Study& stored, const Study& wanted);

}  // namespace vernier::sim::internal
