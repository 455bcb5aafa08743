// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace vernier::internal {

/// Calls work(i) once for every i in [0, count) on at most `threads` threads, the calling one
/// included (0: the number of hardware threads). Calls must be independent and write to separate
/// memory; results then do not depend on the number of threads. The exception with the lowest i is
/// rethrown after all threads have finished.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace vernier::internal
