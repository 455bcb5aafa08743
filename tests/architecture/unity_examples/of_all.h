// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Names that unity_test.py must find twice; never compiled.
namespace vernier {

inline constexpr double of_header[] = {1, 2};
struct OfHeader {};

}  // namespace vernier
