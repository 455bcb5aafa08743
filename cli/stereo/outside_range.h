// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "cli/stereo/stereo_input.h"

namespace vernier::cli {

/// What matches outside the range has a wrong match inside it, of which nothing else shows that:
/// warns if it is a hundredth of the edges, and doubts the result if it is a twentieth. Whether it
/// is doubted.
bool doubt_range(const StereoInput& input, Session& session);

}  // namespace vernier::cli
