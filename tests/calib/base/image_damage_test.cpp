// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/image_damage.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <charconv>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vernier {

using namespace vernier::internal;

namespace {

std::string bytes_of(std::string_view hexadecimal) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2) {
    unsigned char byte = 0;
    std::from_chars(hexadecimal.data() + i, hexadecimal.data() + i + 2, byte, 16);
    bytes += static_cast<char>(byte);
  }
  return bytes;
}

/// 8 x 8 grey pixels, whose coded data end in FF 00 6B.
const std::string jpeg = bytes_of(
    "ffd8ffe000104a46494600010100000100010000ffdb00430002010101010102010101020202020204030202020205"
    "04040304060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affc0000b08"
    "0008000801011100ffc40014000100000000000000000000000000000006ffc4001c10000201050100000000000000"
    "00000000010207000306091121ffda0008010100003f001123ef15a2f6744cb8a143c005ff006bffd9");

/// 6 x 4 grey pixels.
const std::string png = bytes_of(
    "89504e470d0a1a0a0000000d4948445200000006000000040800000000886f119f0000001a49444154081d6364e002"
    "01461b2e1060ace00201c62d5c20000019ee0235b6986e530000000049454e44ae426082");

TEST(ImageDamage, WholeFilesHaveNone) {
  EXPECT_EQ(jpeg_damage(jpeg), "");
  EXPECT_EQ(png_damage(png), "");
  EXPECT_EQ(jpeg_damage(jpeg + "more"), "");
  EXPECT_EQ(png_damage(png + "more"), "");
}

TEST(ImageDamage, BytesBeforeTheEndOfAJpegLoseNoPixels) {
  std::string padded = jpeg;
  padded.insert(padded.size() - 2, "xyz");
  EXPECT_EQ(jpeg_damage(padded), "");
}

TEST(ImageDamage, EveryCutIsSeen) {
  for (std::size_t size = 2; size < jpeg.size(); ++size) {
    EXPECT_EQ(jpeg_damage(jpeg.substr(0, size)), "is cut off (its JPEG data have no end)") << size;
  }
  for (std::size_t size = 8; size < png.size(); ++size) {
    EXPECT_EQ(png_damage(png.substr(0, size)), "is cut off (its PNG data have no end)") << size;
  }
}

TEST(ImageDamage, LostPixelsAreSeenThoughTheFileHasAnEnd) {
  std::string lossy = jpeg;
  lossy.erase(lossy.size() - 10, 8);
  EXPECT_EQ(jpeg_damage(lossy),
            "is damaged (libjpeg: Corrupt JPEG data: premature end of data segment)");
}

TEST(ImageDamage, AWrongChecksumIsSeen) {
  std::string wrong = png;
  wrong[20] ^= 1;  // of the header
  EXPECT_EQ(png_damage(wrong), "is damaged (libpng: IHDR: CRC error)");
}

TEST(ImageDamage, AWrongChecksumIsSeenInAChunkThatThePixelsDoNotNeed) {
  std::string text = png;
  constexpr std::size_t after_header = 8 + 25;
  text.insert(after_header, bytes_of("00000003") + "tEXta" + '\0' + "b" + bytes_of("c2e4d5e1"));
  EXPECT_EQ(png_damage(text), "is damaged (libpng: tEXt: CRC error)");
}

/// A progressive JPEG file whose header says another size.
std::string of_size(unsigned width, unsigned height) {
  cv::Mat pixels(96, 128, CV_8U);
  cv::randu(pixels, 0, 255);
  std::vector<unsigned char> written;
  cv::imencode(".jpg", pixels, written, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  std::string bytes(written.begin(), written.end());
  const std::size_t frame = bytes.find("\xff\xc2");
  int at = 5;
  for (const unsigned value : {height >> 8, height, width >> 8, width}) {
    bytes[frame + at++] = static_cast<char>(value & 255);
  }
  return bytes;
}

long peak_memory_mb() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss / 1024;
}

TEST(ImageDamage, AHeaderOfManyPixelsCostsNoMoreThanTheFileHas) {
  const std::string whole = of_size(11000, 11000);
  const long before_mb = peak_memory_mb();
  const std::size_t first_scan = whole.find("\xff\xda");
  EXPECT_EQ(jpeg_damage(whole.substr(0, first_scan + 40)),
            "is cut off (its JPEG data have no end)");
  EXPECT_EQ(jpeg_damage(whole),
            "is damaged (libjpeg: Corrupt JPEG data: premature end of data segment)");
  EXPECT_LT(peak_memory_mb() - before_mb, 150);  // 240 and more where all pixels are filled in
}

TEST(ImageDamage, MorePixelsThanACameraHasAreRefused) {
  EXPECT_EQ(jpeg_damage(of_size(32000, 32000)),
            "has a header of 32000x32000 pixels, more than can be read (134217728)");
  std::string large = png;
  large.replace(16, 8, bytes_of("0001000000010000"));
  large.replace(29, 4, bytes_of("49ef6f3f"));
  EXPECT_EQ(png_damage(large),
            "has a header of 65536x65536 pixels, more than can be read (134217728)");
}

TEST(ImageDamage, NothingIsPrinted) {
  testing::internal::CaptureStderr();
  jpeg_damage(jpeg.substr(0, 170));
  png_damage(png.substr(0, 50));
  jpeg_damage("no image");
  png_damage("no image");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace vernier
