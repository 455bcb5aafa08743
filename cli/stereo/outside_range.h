// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {

/// What matches outside the range has a wrong match inside it, of which nothing else shows that:
/// warns if it is a hundredth of the edges, and doubts the result if it is a twentieth. Whether
/// there is some.
bool tell_outside_range(const RectifiedPair& pair, const DisparityRange& range, Session& session);

}  // namespace vernier::cli
