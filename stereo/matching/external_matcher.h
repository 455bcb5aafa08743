// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"

namespace vernier::stereo::internal {

struct ExternalMatcherOptions {
  std::string name = {};    ///< empty: that of the program
  double time_limit_s = 0;  ///< for each pair; 0: none. With one, the terminal's interrupt does not
                            ///< reach the program
  double scale = 0;         ///< values a pixel of its map; 0: 256 in a 16-bit PNG, 1 in the rest
  EdgeSampling sampling = EdgeSampling::foreground;
};

/// A program as a matcher, by the command that runs it for a pair:
///
///     my_matcher --left {left} --right {right} --max-disparity {most} -o {output}
///
/// {left} and {right} become the names of the images as 8-bit grey PNG, {least} and {most} the
/// disparities to be searched, {output} the name of the map that it has to write, a PFM.
/// {output.png} and {output.npy} ask for these instead (stereo/disparity_file.h says what is read).
/// The images and the map are in a temporary folder of their own, which is removed whatever
/// happens; the program runs in the folder of the caller.
///
/// The command is parted at blanks; '…' and "…" keep them, a backslash (not within '…') keeps the
/// next letter. No shell takes part: nothing else has a meaning, and names are put in after the
/// parting, so that blanks in them do no harm. Who needs a shell writes sh -c '…' sh {left} … and
/// finds the names in "$1" ….
///
/// What lies more than half a pixel below the range, −1 for instance, counts as not known. Throws
/// Error naming the command where it lacks {left}, {right} or {output}; on matching, where the
/// program is not found, takes longer than the limit, ends with a status that is not 0 (with the
/// last line of its complaint), or leaves no map or none of the images' size.
Matcher external_matcher(const std::string& command, const ExternalMatcherOptions& options = {});

/// The whole map.
DisparityMap external_map(const RectifiedPair& pair,
                          const DisparityRange& range,
                          const std::string& command,
                          const ExternalMatcherOptions& options = {});

}  // namespace vernier::stereo::internal
