// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/grey_image.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "calib/base/byte_order.h"
#include "calib/base/image_file.h"
#include "calib/error.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// A file of these bytes, as long as this lives.
class File {
 public:
  explicit File(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  ~File() { std::filesystem::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_ =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name();
};

std::string coloured_jpeg(const std::vector<int>& options) {
  cv::Mat small(7, 9, CV_8UC3), pixels;
  cv::RNG random(5);
  random.fill(small, cv::RNG::UNIFORM, 0, 255);
  cv::repeat(small, 9, 11, pixels);  // 99 x 63: blocks stand over at the borders
  std::vector<unsigned char> written;
  cv::imencode(".jpg", pixels, written, options);
  return {written.begin(), written.end()};
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(ReadGreyImage, IsSilentAndExactOfAJpegWithBytesBetweenItsSegments) {
  // Exif's orientation: turned by a quarter.
  const std::string turned{
      "\xff\xe1\0\x22"
      "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36};
  for (const int progressive : {0, 1}) {
    const std::string clean = coloured_jpeg({cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    std::string odd = clean;
    odd.insert(2, turned);
    odd.insert(odd.size() - 2, "xy");
    odd.insert(2 + turned.size(), "z");
    const File file(odd);
    testing::internal::CaptureStderr();
    const cv::Mat grey = read_grey_image(file.path());
    const cv::Mat colour = decode_image(read_image_bytes(file.path()), cv::IMREAD_COLOR, "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(grey.size(), cv::Size(99, 63));  // as the sensor had it
    EXPECT_TRUE(same(grey, decode_image(clean, cv::IMREAD_GRAYSCALE, ""))) << progressive;
    EXPECT_TRUE(same(colour, decode_image(clean, cv::IMREAD_COLOR, ""))) << progressive;
  }
}

TEST(ReadGreyImage, GivesTheBytesOfACleanJpegAsTheyAre) {
  const std::string clean = coloured_jpeg({});
  const File file(clean);
  EXPECT_EQ(read_image_bytes(file.path()), clean);
}

TEST(ReadGreyImage, IsSilentOfAPngWithAWrongChecksum) {
  std::vector<unsigned char> written;
  cv::imencode(".png", cv::Mat(4, 6, CV_8U, cv::Scalar(7)), written);
  std::string bytes(written.begin(), written.end());
  bytes.insert(8 + 25, std::string("\0\0\0\3tEXta\0b\1\2\3\4", 15));
  const File file(bytes);
  testing::internal::CaptureStderr();
  EXPECT_THROW(read_grey_image(file.path()), Error);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// A chunk of a PNG file, with its checksum.
std::string png_chunk(const std::string& of_kind) {
  std::uint32_t sum = 0xffffffffu;
  for (const char c : of_kind) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
  }
  std::string chunk;
  append_number(chunk, static_cast<std::uint32_t>(of_kind.size() - 4), true);
  chunk += of_kind;
  append_number(chunk, ~sum, true);
  return chunk;
}

TEST(ReadGreyImage, IsSilentAndExactOfAPngWithABadProfile) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3}) {
    cv::Mat pixels(13, 17, type);
    cv::randu(pixels, cv::Scalar::all(0), cv::Scalar::all(250));
    std::vector<unsigned char> written;
    cv::imencode(".png", pixels, written);
    const std::string clean(written.begin(), written.end());
    std::string odd = clean;
    odd.insert(8 + 25, png_chunk(std::string("iCCPx\0\0no profile", 17)));
    const File file(odd);
    testing::internal::CaptureStderr();
    const cv::Mat grey = read_grey_image(file.path());
    const std::string bytes = read_image_bytes(file.path());
    for (const int flags : {int{cv::IMREAD_UNCHANGED}, cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH}) {
      EXPECT_TRUE(same(decode_image(bytes, flags, ""), decode_image(clean, flags, ""))) << type;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    const File other(clean);
    EXPECT_TRUE(same(grey, read_grey_image(other.path())));
  }
}

// OpenCV gives bytes that none of its common decoders takes to GDCM, which ended the process on a
// file that names itself DICOM and is none.
TEST(ReadGreyImage, WhatOnlyLooksLikeAnImageReachesNoOtherDecoder) {
  const std::string jpeg = "\xff\xd8\x07", netpbm = "P5x1 1 1\n",
                    webp = std::string("RIFF\x7f\0\0\0WEBPVP8 \x7f\0\0\0", 20);
  for (const std::string& head : {jpeg, netpbm, webp}) {
    std::string bytes = head + std::string(128 - head.size(), '\x84') + "DICM{\x88P";
    const File file(bytes);
    EXPECT_EQ(test::error_message([&] { read_grey_image(file.path()); }),
              file.path().string() + ": is not an image that can be read; check the file");
  }
}

TEST(ReadGreyImage, SizesAreRefusedBeforeTheyAreDecoded) {
  std::vector<std::string> large{"P5 20000 20000 255\n", "P2 20000 20000 255\n",
                                 "P4 20000 20000\n"};
  for (const char* kind : {".bmp", ".tiff"}) {
    std::vector<unsigned char> written;
    cv::imencode(kind, cv::Mat(4, 6, CV_8U, cv::Scalar(7)), written);
    large.emplace_back(written.begin(), written.end());
  }
  for (const std::size_t at : {18, 22}) large[3].replace(at, 4, std::string("\x20\x4e\0\0", 4));
  const std::size_t tags = number_at<std::uint32_t>(large[4], 4, false);
  for (const std::size_t tag : {256, 257}) {
    std::size_t at = tags + 2;
    while (number_at<std::uint16_t>(large[4], at, false) != tag) at += 12;
    large[4].replace(at + 8, 2, "\x20\x4e");
  }
  for (const std::string& bytes : large) {
    const File file(bytes);
    EXPECT_NE(test::error_message([&] {
                read_grey_image(file.path());
              }).find("has a header of 20000x20000 pixels, more than can be read"),
              std::string::npos)
        << bytes.substr(0, 2) << test::error_message([&] { read_grey_image(file.path()); });
  }
}

}  // namespace
}  // namespace vernier
