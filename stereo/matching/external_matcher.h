// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"

namespace vernier::stereo::internal {

/// How many values of a map are within the range asked for, and how many above it.
struct MapRange {
  std::size_t within = 0, above = 0;

  double share_above() const {
    return above == 0 ? 0 : static_cast<double>(above) / static_cast<double>(within + above);
  }
};

struct ExternalMatcherOptions {
  std::string name = {};  ///< empty: name of the program
  /// Per pair; 0: none. With a limit, the terminal's interrupt does not reach the program.
  double time_limit_s = 0;
  double scale = 0;  ///< file values per pixel; 0: 256 for a 16-bit PNG, else 1
  EdgeSampling sampling = EdgeSampling::foreground;
  std::function<void(const MapRange&)> told = {};  ///< called with every map's
};

/// Runs a program as a matcher, by a command line per pair:
///
///     my_matcher --left {left} --right {right} --max-disparity {most} -o {output}
///
/// {left} and {right} are replaced by the images as 8-bit grey PNG, {least} and {most} by the
/// disparity range, and {output} by the file to be written, a PFM. {output.png} and {output.npy}
/// request these formats instead (stereo/disparity_file.h). Images and map are in a temporary
/// folder, which is always removed; the program runs in the caller's working directory.
///
/// The command is split at blanks; '…' and "…" quote, a backslash (not within '…') escapes the next
/// character. No shell is involved: nothing else is special, and placeholders are replaced after
/// splitting, so blanks in file names are safe. To use a shell, write sh -c '…' sh {left} … and
/// refer to "$1" ….
///
/// Disparities more than half a pixel outside the range, such as −1, are unknown. Throws Error
/// naming the command if {left}, {right} or {output} is missing, or if a word without blanks has
/// another {name} (not ${name}); when matching, if the program is not found, exceeds the time
/// limit, exits with a non-zero status (with its last line of output), or writes no map or one of
/// another size, or if a PNG would have to hold negative disparities.
Matcher external_matcher(const std::string& command, const ExternalMatcherOptions& options = {});

/// The dense disparity map.
DisparityMap external_map(const RectifiedPair& pair,
                          const DisparityRange& range,
                          const std::string& command,
                          const ExternalMatcherOptions& options = {});

}  // namespace vernier::stereo::internal
