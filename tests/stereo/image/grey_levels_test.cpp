// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/grey_levels.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::stereo;

namespace {

template <typename Value>
cv::Mat ramp(int channels) {
  cv::Mat pixels(5, 7, CV_MAKETYPE(cv::DataType<Value>::depth, channels));
  for (int y = 0; y < 5; ++y) {
    for (int i = 0; i < 7 * channels; ++i) {
      pixels.ptr<Value>(y)[i] = static_cast<Value>(y * 7919 + i * 104729);
    }
  }
  return pixels;
}

class GreyLevelsOfFile : public testing::Test {
 protected:
  std::filesystem::path save(const std::string& name, const cv::Mat& pixels) const {
    cv::imwrite((folder_.path() / name).string(), pixels);
    return folder_.path() / name;
  }
  GreyLevels read(const std::filesystem::path& file) { return read_grey_levels(file, &remark_); }

  test::Folder folder_;
  std::string remark_ = "unset";
};

TEST_F(GreyLevelsOfFile, AreThoseOfAnEightBitImageWithoutRemark) {
  const cv::Mat pixels = ramp<uchar>(1);
  const GreyLevels grey = read(save("grey.png", pixels));
  EXPECT_EQ(remark_, "");
  ASSERT_EQ(grey.width_px, 7);
  ASSERT_EQ(grey.height_px, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) EXPECT_EQ(grey(x, y), pixels.at<uchar>(y, x));
  }
}

TEST_F(GreyLevelsOfFile, WeighColoursAsBt601Says) {
  const cv::Mat pixels = ramp<uchar>(3);
  const GreyLevels grey = read(save("colour.png", pixels));
  EXPECT_EQ(remark_, "colour image, converted to grey");
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const auto bgr = pixels.at<cv::Vec3b>(y, x);
      EXPECT_NEAR(grey(x, y), 0.299 * bgr[2] + 0.587 * bgr[1] + 0.114 * bgr[0], 1e-3);
    }
  }
}

/// Of the file's range, not of the brightest pixel: both images of a pair are scaled alike.
TEST_F(GreyLevelsOfFile, ScaleDeepImagesByTheirWholeRange) {
  cv::Mat pixels = ramp<ushort>(1);
  GreyLevels grey = read(save("deep.png", pixels));
  EXPECT_EQ(remark_, "16-bit image, scaled by 1/257");
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) EXPECT_NEAR(grey(x, y), pixels.at<ushort>(y, x) / 257.0, 1e-4);
  }
  pixels = pixels / 64;
  grey = read(save("dim.png", pixels));
  EXPECT_NE(remark_.find("scaled by 1/257; its largest value is only 1"), std::string::npos);
  EXPECT_NEAR(grey(3, 2), pixels.at<ushort>(2, 3) / 257.0, 1e-4);
  read(save("colours.png", ramp<ushort>(3)));
  EXPECT_EQ(remark_, "16-bit colour image, converted to grey, scaled by 1/257");
}

TEST_F(GreyLevelsOfFile, TakeTheRangeOfNetpbmFromItsHead) {
  GreyLevels grey =
      read(folder_.write("ten.pgm", std::string("P5 2 1 1023\n\x03\xff\x01\x00", 16)));
  EXPECT_EQ(remark_, "16-bit image, scaled by 1/4.01176");
  EXPECT_NEAR(grey(0, 0), 255, 1e-4);
  EXPECT_NEAR(grey(1, 0), 255 * 256.0 / 1023, 1e-4);
  grey = read(folder_.write("six.pgm", std::string("P5\n# six bits\n2 1\n63\n\x3f\x10")));
  EXPECT_EQ(remark_, "image, scaled by 4.04762");
  EXPECT_NEAR(grey(0, 0), 255, 1e-4);
  EXPECT_NEAR(grey(1, 0), 255 * 16 / 63.0, 1e-4);
}

TEST_F(GreyLevelsOfFile, RefuseWhatIsNoImage) {
  const auto message = [&](const std::filesystem::path& file) {
    return test::error_message([&] { read_grey_levels(file); });
  };
  EXPECT_NE(message(folder_.path() / "none.png").find("none.png: cannot be read"),
            std::string::npos);
  EXPECT_NE(message(folder_.write("text.png", "hello")).find("is not an image"), std::string::npos);
  EXPECT_NE(message(folder_.write("empty.png", "")).find("is not an image"), std::string::npos);
  EXPECT_NE(message(folder_.path()).find("is a folder"), std::string::npos);
  const auto whole = save("whole.png", ramp<uchar>(3));
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) - 9);
  EXPECT_NE(message(whole).find("is cut off"), std::string::npos);
  const auto real = save("real.tiff", cv::Mat(3, 3, CV_32F, cv::Scalar(0.5)));
  EXPECT_NE(message(real).find("neither unsigned 8-bit nor unsigned 16-bit"), std::string::npos);
}

}  // namespace
}  // namespace vernier
