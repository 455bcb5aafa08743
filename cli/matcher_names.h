// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "stereo/matcher.h"

namespace vernier::cli {

/// The matchers of a list such as "edge,bm,sgbm", then those of commands with {left}, {right} and
/// {output} in them (stereo/external_matcher.h). Throws Error for a name that is none.
std::vector<Matcher> matchers_named(const std::string& names,
                                    const std::vector<std::string>& commands);

/// The one that `command` runs or, where that is empty, `name` names. Throws Error for several.
Matcher one_matcher(const std::string& name, const std::string& command);

}  // namespace vernier::cli
