// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::sim::internal {

/// The name of this machine, at most 64 characters; "?" if it has none.
std::string host_name();

}  // namespace vernier::sim::internal
