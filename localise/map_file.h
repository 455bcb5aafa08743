// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "localise/topological_map.h"

namespace vernier::localise {

/// Writes a map as a file of format "vernier map" (docs/file-formats.md), version 1, or 2 if a node
/// has corners, complete or not at all. Nodes that follow each other with the same rig and mount
/// share one copy of them. Throws Error for a node that is not finite or beyond the limits of
/// read_map(), and if the file cannot be written.
void write_map(const std::filesystem::path& file, const TopologicalMap& map);

/// Reads a map; the file is mapped into memory, not copied first. Throws Error naming the file for
/// another format or version, a part that does not have its checksum, a file cut short, a number
/// that is not finite, and more than 1,000,000 nodes, 10,000 lines or corners in one.
TopologicalMap read_map(const std::filesystem::path& file);

/// Adds nodes to a map in a file: the parts that it holds are checked and kept to the byte. Of
/// several that extend one map at once, each adds to what those before it left. Throws Error as
/// both of the above.
void extend_map(const std::filesystem::path& file, std::span<const MapNode> nodes);

}  // namespace vernier::localise
