// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace vernier::sim::internal {

/// What a child of this process makes: a piece of work by a library that may crash or hang on a
/// damaged file. `work` runs in a copy of this process (fork), may throw Error, and returns bytes.
/// Throws Error(place) where it did, where it crashed, and where it took more CPU time.
std::string in_child_process(const std::function<std::string()>& work,
                             double cpu_limit_s,
                             const std::string& place);

/// What the child tells its parent: the bytes of `work`, or the Error that it threw, which is
/// thrown again. An Error too for bytes that it does not write.
std::string child_result(const std::string& told, const std::string& place);

}  // namespace vernier::sim::internal
