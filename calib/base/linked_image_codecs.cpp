// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>

#include "calib/base/image_codecs.h"

namespace vernier::internal {

cv::Mat decode_by_imgcodecs(cv::InputArray bytes, int flags) { return cv::imdecode(bytes, flags); }

void encode_by_imgcodecs(const std::string& ending,
                         cv::InputArray pixels,
                         std::vector<unsigned char>& bytes,
                         const std::vector<int>& options) {
  cv::imencode(ending, pixels, bytes, options);
}

}  // namespace vernier::internal
