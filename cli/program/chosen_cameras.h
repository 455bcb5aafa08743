// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier::cli {

/// The words of a list such as "left,right".
std::vector<std::string> listed(const std::string& list);

/// The cameras that an option `--cameras left,right` names, as indices in its order; all of the rig
/// if it is empty. Throws Error for a name that is none of the rig's or is given twice.
std::vector<int> chosen_cameras(const Rig& rig, const std::string& list);

/// Throws Error unless two cameras were chosen by `list`: naming the option, or `file` if the list
/// is empty.
void require_chosen_pair(const Rig& rig, const std::string& list, const std::string& file);

}  // namespace vernier::cli
