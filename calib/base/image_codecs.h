// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace vernier::internal {

/// cv::imdecode and cv::imencode, by the library that was linked or, at the first call, is loaded
/// (cmake/VernierImageCodecs.cmake). Throw Error if it cannot be loaded, std::bad_alloc if there is
/// no room for it, and what they throw. Safe to call from several threads.
cv::Mat decode_by_imgcodecs(cv::InputArray bytes, int flags);
void encode_by_imgcodecs(const std::string& ending,
                         cv::InputArray pixels,
                         std::vector<unsigned char>& bytes,
                         const std::vector<int>& options);

/// The library to load, and its two functions as the linker knows them. Written by CMake.
struct ImgcodecsLibrary {
  const char* name;
  const char* imdecode;
  const char* imencode;
};
extern const ImgcodecsLibrary imgcodecs_library;

}  // namespace vernier::internal
