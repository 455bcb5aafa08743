// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/map/node_grid.h"
#include "localise/place/space_lines.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// A node's lines, which count, and those of nodes within 1.1 m and 60 degrees that it has not
/// recorded itself, which do not: what may be seen from near the node. In the node's frame. Those
/// of the node `left_out` are not used.
SpaceLines merged_lines(const TopologicalMap& map,
                        const NodeGrid& grid,
                        int node,
                        int left_out = -1);

}  // namespace vernier::localise::internal
