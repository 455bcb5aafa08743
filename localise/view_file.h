// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"

namespace vernier::localise {

/// What was seen from one position.
struct RecordedLooks {
  std::vector<Look> looks;     ///< at least one; the first has no turn
  std::optional<Pose2D> pose;  ///< of the first look, where it is known
};

/// Reads views, one position a line of JSON (docs/file-formats.md): lines in space in the robot
/// frame and image lines, or matched segments of both images, from which the rig gives both; and
/// corners of both images.
/// `rig` is that of views that name no cameras; null: these have none, and segments are refused.
/// Throws Error naming file, line and key for what is malformed, not finite, in another unit
/// (lines beyond 1,000 m, headings beyond a turn, pixels far off the image) or of no length, and
/// for more than 100,000 positions, 64 looks or 10,000 lines in one.
std::vector<RecordedLooks> read_views(const std::filesystem::path& file,
                                      const std::shared_ptr<const Rig>& rig = nullptr);

/// One line of such a file, with its end.
std::string view_line(const RecordedLooks& view);

/// Writes what read_views() reads, complete or not at all. Throws Error if it cannot.
void write_views(const std::filesystem::path& file, std::span<const RecordedLooks> views);

}  // namespace vernier::localise
