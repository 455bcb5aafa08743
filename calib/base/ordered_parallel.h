// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace vernier::internal {

/// Calls work(i) once for every i in [0, count) on at most `threads` threads (0: as many as the
/// machine has), this one among them. Work on different i must be independent and write to its own
/// place; then results do not depend on the number of threads. The first exception by i is thrown
/// here after all threads are done.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace vernier::internal
