// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace vernier::internal {

/// The fault of the bytes of a JPEG file, "is cut off …" or "is damaged …", as reported by libjpeg
/// when it decodes the pixels at an eighth of their size, which reads all data; "has a header of …"
/// for more pixels than a camera has. Empty if there is none. Extra bytes between the pixel data
/// and the next marker are no fault. Also empty for files that libjpeg cannot decode at all, such
/// as an unsupported colour space: they are not damaged. `warned` tells whether libjpeg warned of
/// anything, which another decoder would print.
std::string jpeg_damage(std::string_view bytes, bool* warned = nullptr);

/// The same for a PNG file, by libpng: "is cut off …" if its end is missing, "is damaged …" for any
/// other error, such as a wrong checksum.
std::string png_damage(std::string_view bytes, bool* warned = nullptr);

}  // namespace vernier::internal
