// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stereo/matcher.h"

namespace vernier::stereo::internal {

/// The matchers that the library has, by the names that users give: edge, stretch, bm, sgbm.
const std::vector<std::string>& built_in_matchers();

/// With its defaults. Throws std::out_of_range for another name.
Matcher built_in_matcher(const std::string& name);

}  // namespace vernier::stereo::internal
