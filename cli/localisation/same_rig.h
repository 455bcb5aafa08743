// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "cli/program/namespaces.h"
#include "localise/topological_map.h"

namespace vernier::cli {

/// Throws Error(map_name) if a map was recorded with cameras of another size, focal length (by more
/// than 5 %), lens (corners of the image that look 5 degrees elsewhere) or baseline (10 %) than the
/// rig that asks. Maps hold lines in metres, but what a view
/// can hold of them depends on its cameras; a new calibration of the same rig differs by far less.
void check_same_rig(const TopologicalMap& map, const Rig& rig, const std::string& map_name);

/// Throws Error(file) if a view of a new map was not taken with the rig of the first one, by the
/// same limits.
void check_one_rig(const Rig& first,
                   const Rig& rig,
                   const std::string& file,
                   const std::string& view);

}  // namespace vernier::cli
