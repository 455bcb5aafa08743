// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Adds `world build` to the verb `world`.
void add_world_build(CLI::App& world, Session& session);

}  // namespace vernier::cli
