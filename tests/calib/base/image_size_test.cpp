// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/image_size.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/byte_order.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string encoded(const char* kind, int width, int height, const std::vector<int>& how = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(kind, cv::Mat(height, width, CV_8UC3, cv::Scalar(10, 200, 90)), bytes, how);
  return {bytes.begin(), bytes.end()};
}

std::pair<int, int> size_of(const std::string& bytes) {
  const auto size = bitmap_size(bytes);
  if (!size) return {0, 0};
  return {static_cast<int>(size->width), static_cast<int>(size->height)};
}

TEST(ImageSize, IsReadFromTheHeadersThatOpenCvWrites) {
  const std::pair wanted(301, 207);
  EXPECT_EQ(size_of(encoded(".bmp", 301, 207)), wanted);
  EXPECT_EQ(size_of(encoded(".tiff", 301, 207)), wanted);
  EXPECT_EQ(size_of(encoded(".webp", 301, 207, {cv::IMWRITE_WEBP_QUALITY, 50})), wanted);
  EXPECT_EQ(size_of(encoded(".webp", 301, 207, {cv::IMWRITE_WEBP_QUALITY, 101})), wanted);
}

TEST(ImageSize, IsReadFromTiffOfEitherByteOrder) {
  for (const bool big : {false, true}) {
    std::string bytes = big ? "MM" : "II";
    append_number(bytes, std::uint16_t{42}, big);
    append_number(bytes, std::uint32_t{8}, big);
    append_number(bytes, std::uint16_t{2}, big);
    for (const std::uint16_t tag : {256, 257}) {
      append_number(bytes, tag, big);
      append_number(bytes, std::uint16_t{4}, big);
      append_number(bytes, std::uint32_t{1}, big);
      append_number(bytes, std::uint32_t{70'000u + tag}, big);
    }
    EXPECT_EQ(size_of(bytes), std::pair(70'256, 70'257));
  }
}

TEST(ImageSize, ABottomUpOrTopDownBmpHasAHeight) {
  std::string bytes = encoded(".bmp", 8, 4);
  bytes.replace(22, 4, "\xfc\xff\xff\xff");
  EXPECT_EQ(size_of(bytes), std::pair(8, 4));
}

TEST(ImageSize, CutHeadersHaveNone) {
  for (const char* kind : {".bmp", ".tiff", ".webp"}) {
    const std::string whole = encoded(kind, 30, 20);
    for (std::size_t size = 0; size < 40; ++size) bitmap_size(whole.substr(0, size));
    EXPECT_FALSE(bitmap_size(whole.substr(0, 12)));
  }
  EXPECT_FALSE(bitmap_size("no image"));
}

TEST(ImageSize, MorePixelsThanTheLimitAreRefused) {
  EXPECT_EQ(size_fault({11'585, 11'585}), "");
  EXPECT_EQ(size_fault({1 << 20, 128}), "");
  EXPECT_NE(size_fault({(1 << 20) + 1, 1}), "");
  EXPECT_EQ(size_fault({11'586, 11'586}),
            "has a header of 11586x11586 pixels, more than can be read (134217728)");
  EXPECT_NE(size_fault({std::uint64_t{1} << 63, 2}), "");
}

}  // namespace
}  // namespace vernier
