// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace vernier::internal {

/// A PNG file of the same pixels, palette and transparency without the other chunks, such as colour
/// profiles, of which libpng warns. Empty where libpng cannot read the file.
std::string rewritten_png(std::string_view bytes);

}  // namespace vernier::internal
