// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace vernier::internal {

/// A JPEG file of the same pixels, to the bit, without what libjpeg warns of, such as bytes between
/// its segments: the coefficients are taken over as they are. Empty where that cannot be done: for
/// what libjpeg cannot read, or a progressive file without its last scans, whose missing digits
/// decoders guess.
std::string rewritten_jpeg(std::string_view bytes);

}  // namespace vernier::internal
