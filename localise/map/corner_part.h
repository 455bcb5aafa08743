// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// The part of a map file that holds the corners of the nodes of the part after it: for each node
/// the number of corners and the entries of a descriptor (4 bytes each), then the corners: left
/// and right pixel (4 doubles), the upper triangle of the covariance by rows (10 doubles) and the
/// descriptor (floats, filled up to 8 bytes). All numbers are little-endian.
std::string corner_bytes(std::span<const MapNode> nodes);

/// Bytes of a corner with a descriptor of so many entries.
std::size_t corner_size(std::size_t descriptor);

/// Whether any of the nodes has corners.
bool have_corners(std::span<const MapNode> nodes);

/// Whether the corners of a node can be written: finite, within the limits, at most 10,000, and
/// with descriptors of one length, at most 1024.
bool writable(std::span<const StereoCorner> corners);

/// Reads a part for these nodes. Throws what `fail` throws, which is told what is wrong.
void read_corners(std::string_view bytes,
                  std::span<MapNode> nodes,
                  const std::function<void(const std::string&)>& fail);

}  // namespace vernier::localise::internal
