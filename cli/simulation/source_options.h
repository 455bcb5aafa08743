// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "sim/sources.h"

namespace vernier::cli {

/// Applies settings of --source such as "edge_loss=0.2" to `settings`; "none", given first, turns
/// all sources off. Throws Error for what is unknown, out of range, given twice or without effect.
SourceSettings sources_of(const std::vector<std::string>& words, SourceSettings settings);

}  // namespace vernier::cli
