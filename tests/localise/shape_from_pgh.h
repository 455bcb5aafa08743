// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/pgh.h"
#include "stereo/segment.h"

namespace vernier::test {

using Shape = std::vector<stereo::ImageSegment>;

/// All shapes that have these plain histograms of lines in a plane, from the bins alone: neither
/// weights nor masses are used, nor the code that makes histograms. In each row, the entries of
/// other lines are read off: the angle of each, and the two ends of its range of distances. The
/// angle of a pair stands in two rows, which tells whose entry it is. Then lines are placed one by
/// one relative to the first, which starts at the origin and points along x, with every choice of
/// signs that the type leaves open, and dropped where they contradict an entry by more than
/// `tolerance` (in the unit of distance).
///
/// The lines must be in general position: no two entries of a row that overlap in angle, no equal
/// angles in different rows except of the same pair, and, but for `directed`, no line cut in its
/// middle by another's extension. If not, or if nothing agrees: none. The order of a line's ends is
/// found for `directed` only.
std::vector<Shape> shapes_from_histograms(const localise::HistogramRows& histograms,
                                          const localise::PghAxes& axes,
                                          localise::PghType type,
                                          double tolerance);

}  // namespace vernier::test
