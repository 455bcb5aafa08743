// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace vernier::internal {

/// What is wrong with the bytes of a JPEG file: "is cut off …" or "is damaged …", as libjpeg finds
/// when it decodes the pixels at an eighth of their size, which reads all of the data; empty where
/// nothing is. Bytes between the pixels' data and the next marker harm nothing. Empty as well for
/// what libjpeg cannot decode at all, such as another colour space: that is no damage. "has a
/// header of …" for more pixels than a camera has. `warned` says whether libjpeg warned of
/// anything: another decoder would print that.
std::string jpeg_damage(std::string_view bytes, bool* warned = nullptr);

/// The same of a PNG file, by libpng: "is cut off …" where it has no end, "is damaged …" for every
/// other error, such as a wrong checksum.
std::string png_damage(std::string_view bytes);

}  // namespace vernier::internal
