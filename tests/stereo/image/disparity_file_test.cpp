// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Files are put together byte by byte here, as their formats say, and not by the writer under test.
#include "stereo/disparity_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::stereo;

namespace {

constexpr float not_known = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

/// This machine's bytes of values, turned round for the other order.
template <typename Value>
std::string bytes_of(const std::vector<Value>& values, bool turned) {
  std::string bytes;
  for (const Value value : values) {
    std::string own(sizeof(Value), '\0');
    std::memcpy(own.data(), &value, sizeof(Value));
    if (turned) std::reverse(own.begin(), own.end());
    bytes += own;
  }
  return bytes;
}

std::string npy(const std::string& type,
                const std::string& data,
                const std::string& shape = "(2, 3)",
                const std::string& fortran = "False") {
  const std::string text =
      "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(text.size()) + '\0' + text + data;
}

bool same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

class DisparityFile : public testing::Test {
 protected:
  std::filesystem::path save(const std::string& name, const cv::Mat& pixels) const {
    cv::imwrite((folder_.path() / name).string(), pixels);
    return folder_.path() / name;
  }
  void expect(const std::filesystem::path& file,
              const std::vector<float>& wanted,
              const DisparityFileOptions& options = {}) const {
    const DisparityMap map = read_disparity(file, options);
    ASSERT_EQ(map.width_px, 3) << file;
    ASSERT_EQ(map.height_px, 2) << file;
    ASSERT_EQ(map.values.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_TRUE(same(map.values[i], wanted[i]))
          << file << " [" << i << "]: " << map.values[i] << ", not " << wanted[i];
    }
  }
  /// The complaint about a file of these bytes: one line that begins with its name.
  std::string error_output(const std::string& bytes) const {
    return error_output(folder_.write("bad", bytes));
  }
  std::string error_output(const std::filesystem::path& file) const {
    const std::string message = test::error_message([&] { read_disparity(file); });
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  }
  void expect_complaint(const std::string& bytes, const std::string& part) const {
    EXPECT_NE(error_output(bytes).find(part), std::string::npos) << error_output(bytes);
  }

  test::Folder folder_;
};

TEST_F(DisparityFile, ReadsPfmOfBothByteOrdersFromTheBottom) {
  const std::vector<float> bottom_up = {4.5f, infinite, -1, 1, 0, not_known};
  const std::vector<float> wanted = {1, 0, not_known, 4.5f, not_known, -1};
  expect(folder_.write("little", "Pf\n3 2\n-1.0\n" + bytes_of(bottom_up, false)), wanted);
  expect(folder_.write("big", "Pf\n3 2\n1.0\n" + bytes_of(bottom_up, true)), wanted);
  expect(folder_.write("middlebury", "Pf 3 2 -0.003922\n" + bytes_of(bottom_up, false)), wanted);
  expect(folder_.write("crlf", "Pf\r\n3 2\r\n-1\r\n" + bytes_of(bottom_up, false)), wanted);
}

TEST_F(DisparityFile, ReadsImagesByTheirScale) {
  const cv::Mat bytes = (cv::Mat_<uchar>(2, 3) << 0, 8, 20, 255, 1, 16);
  expect(save("8.png", bytes), {not_known, 1, 2.5f, 31.875f, 0.125f, 2}, {.scale = 8});
  expect(save("8.pgm", bytes), {not_known, 8, 20, 255, 1, 16});
  cv::Mat colours;
  cv::merge(std::vector<cv::Mat>{bytes, bytes, bytes}, colours);
  expect(save("grey_as_colour.png", colours), {not_known, 8, 20, 255, 1, 16});
  const cv::Mat words = (cv::Mat_<ushort>(2, 3) << 0, 256, 384, 65535, 1, 25600);
  expect(save("16.png", words), {not_known, 1, 1.5f, 65535 / 256.f, 1 / 256.f, 100},
         {.scale = 256});
}

TEST_F(DisparityFile, ReadsNumpyArraysOfManyTypes) {
  const std::vector<float> real = {1, not_known, 2.25f, infinite, 0, -3};
  const std::vector<float> wanted_real = {1, not_known, 2.25f, not_known, 0, -3};
  expect(folder_.write("<f4", npy("<f4", bytes_of(real, false))), wanted_real);
  expect(folder_.write(">f4", npy(">f4", bytes_of(real, true))), wanted_real);
  const std::vector<double> wide(real.begin(), real.end());
  expect(folder_.write("<f8", npy("<f8", bytes_of(wide, false))), wanted_real);
  expect(folder_.write(">f8", npy(">f8", bytes_of(wide, true))), wanted_real);
  const std::vector<float> wanted = {not_known, 1, 2, 3, 100, 127};
  const auto expect_whole = [&](const std::string& name, auto zero) {
    const std::vector<decltype(zero)> whole = {zero, 1, 2, 3, 100, 127};
    const bool one_byte = sizeof(zero) == 1;
    const std::string little = (one_byte ? "|" : "<") + name;
    expect(folder_.write("a" + name, npy(little, bytes_of(whole, false))), wanted);
    if (!one_byte)
      expect(folder_.write("b" + name, npy(">" + name, bytes_of(whole, true))), wanted);
  };
  expect_whole("u1", std::uint8_t{0});
  expect_whole("u2", std::uint16_t{0});
  expect_whole("u4", std::uint32_t{0});
  expect_whole("u8", std::uint64_t{0});
  expect_whole("i1", std::int8_t{0});
  expect_whole("i2", std::int16_t{0});
  expect_whole("i4", std::int32_t{0});
  expect_whole("i8", std::int64_t{0});
}

TEST_F(DisparityFile, TakesOutWhatTheOptionsCallUnknown) {
  const auto real =
      folder_.write("r", npy("<f4", bytes_of<float>({-16, 0, 16, 8, -8, 1e30f}, false)));
  expect(real, {-1, 0, 1, 0.5f, -0.5f, 6.25e28f}, {.scale = 16});
  expect(real, {-1, not_known, 1, 0.5f, -0.5f, 6.25e28f}, {.scale = 16, .zero_is_unknown = true});
  expect(real, {not_known, 0, 1, 0.5f, -0.5f, 6.25e28f}, {.scale = 16, .min_px = -0.5});
  const auto whole =
      folder_.write("w", npy("|i1", bytes_of<std::int8_t>({-1, 0, 1, 2, 3, 4}, false)));
  expect(whole, {-1, 0, 1, 2, 3, 4}, {.zero_is_unknown = false});
  const auto wide =
      folder_.write("d", npy("<f8", bytes_of<double>({1e300, -1e300, 1, 2, 3, 4}, false)));
  expect(wide, {not_known, not_known, 1, 2, 3, 4});
  EXPECT_NE(test::error_message([&] { read_disparity(wide, {.scale = 0}); }).find("positive"),
            std::string::npos);
}

TEST_F(DisparityFile, RefusesBadPfm) {
  const std::string data = bytes_of<float>({1, 2, 3, 4, 5, 6}, false);
  expect_complaint("PF\n3 2\n-1\n" + data + data + data, "PFM of 3 channels");
  expect_complaint("Pf\n3 2\n-1\n" + data.substr(1), "has 23 bytes of values, fewer than the 24");
  expect_complaint("Pf\n3 2\n-1\n" + data + "x", "has 25 bytes of values, more than the 24");
  expect_complaint("Pf\n3 2\n-1", "truncated or damaged");
  expect_complaint("Pf\n3", "truncated or damaged");
  expect_complaint("Pf", "truncated or damaged");
  expect_complaint("Pf\nthree 2\n-1\n" + data, "three");
  expect_complaint("Pf\n0 2\n-1\n", "the size 0 x 2");
  expect_complaint("Pf\n3 -2\n-1\n" + data, "the size 3 x -2");
  expect_complaint("Pf\n1000000000 1000000000\n-1\n" + data, "the size 1000000000 x 1000000000");
  expect_complaint("Pf\n99999999999 2\n-1\n" + data, "99999999999");
  expect_complaint("Pf\n1000000 1000000\n-1\n" + data, "a header of 1000000x1000000 pixels");
  expect_complaint("Pf\n3 2\n0\n" + data, "scale is 0");
  expect_complaint("Pf\n3 2\nnan\n" + data, "scale");
}

TEST_F(DisparityFile, RefusesBadNumpyArrays) {
  const std::string data = bytes_of<float>({1, 2, 3, 4, 5, 6}, false);
  const std::string good = npy("<f4", data);
  expect_complaint(good.substr(0, good.size() - 1), "has 23 bytes of values, fewer than the 24");
  expect_complaint(good + "xy", "has 26 bytes of values, more than the 24");
  for (const std::size_t length : {6, 9, 10, 30}) {
    expect_complaint(good.substr(0, length), "cut off in its NumPy header");
  }
  expect_complaint(npy("<f4", data, "(2, 3)", "True"), "Fortran (column-major) order");
  expect_complaint(npy("<f4", data, "(6,)"), "has 1 dimensions, not 2");
  expect_complaint(npy("<f4", data, "(2, 3, 1)"), "has 3 dimensions, not 2");
  expect_complaint(npy("<f4", "", "(0, 3)"), "a dimension of 0");
  expect_complaint(npy("<f4", data, "(-2, 3)"), "a dimension of -2");
  expect_complaint(npy("<f4", data, "(2.5, 3)"), "a dimension of 2.5");
  expect_complaint(npy("<f4", data, "(1e18, 3)"), "a dimension of 1e18");
  expect_complaint(npy("<f4", data, "(1000000, 1000000)"), "a header of 1000000x1000000 pixels");
  for (const char* type : {"<c8", "|b1", "<f2", "<U4", "|O", "", "<i3", "f4", "xf4"}) {
    expect_complaint(npy(type, data), std::string("data type ") + type);
  }
  std::string other = good;
  other[6] = '\x07';
  expect_complaint(other, "version 7");
  std::string torn = good;
  torn[10] = '(';
  EXPECT_NE(error_output(torn), "");
  expect_complaint(std::string("\x93NUMPY\x01\x00\x03\x00{ }", 13), "without descr");
}

TEST_F(DisparityFile, RefusesOtherImages) {
  cv::Mat colours = cv::Mat::zeros(4, 4, CV_8UC3);
  colours.at<cv::Vec3b>(3, 2)[1] = 1;
  EXPECT_NE(error_output(save("colour.png", colours)).find("colour"), std::string::npos);
  EXPECT_NE(error_output(save("clear.png", cv::Mat::zeros(4, 4, CV_8UC4))).find("alpha channel"),
            std::string::npos);
  cv::imwrite((folder_.path() / "bit.png").string(), cv::Mat::zeros(4, 4, CV_8U),
              {cv::IMWRITE_PNG_BILEVEL, 1});
  EXPECT_NE(error_output(folder_.path() / "bit.png").find("fewer than 8 bits"), std::string::npos);
  EXPECT_NE(error_output(save("lossy.jpg", cv::Mat::zeros(4, 4, CV_8U))).find("neither PFM"),
            std::string::npos);
  const auto cut = save("cut.png", cv::Mat(40, 40, CV_16U, cv::Scalar(7)));
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 20);
  EXPECT_NE(error_output(cut).find("cut off"), std::string::npos);
  expect_complaint("P5 3 2 255\nabcde", "cut off");
  expect_complaint("P5 0 0 255\n", "is not an image");
  expect_complaint("PK\x03\x04", "archive");
  expect_complaint("", "is empty");
  expect_complaint("disparity", "neither PFM");
  EXPECT_NE(error_output(folder_.path() / "none.pfm").find("cannot be read"), std::string::npos);
}

TEST_F(DisparityFile, ReadsBackWhatItWrote) {
  DisparityMap map{5, 3, {}};
  for (int i = 0; i < 15; ++i) map.values.push_back(i % 4 == 0 ? not_known : 0.1f * i * i - 2);
  for (const char* name : {"map.pfm", "map.npy"}) {
    write_disparity(folder_.path() / name, map);
    const DisparityMap read = read_disparity(folder_.path() / name);
    ASSERT_EQ(read.width_px, 5);
    ASSERT_EQ(read.height_px, 3);
    for (int i = 0; i < 15; ++i) EXPECT_TRUE(same(read.values[i], map.values[i])) << name << i;
  }
  for (float& value : map.values) value = std::abs(value);
  map.values[1] = 0, map.values[2] = 255.99f;
  write_disparity(folder_.path() / "map.png", map);
  const DisparityMap read = read_disparity(folder_.path() / "map.png", {.scale = 256});
  for (int i = 0; i < 15; ++i) {
    EXPECT_EQ(std::isnan(read.values[i]), std::isnan(map.values[i])) << i;
    if (std::isnan(map.values[i])) continue;
    EXPECT_NEAR(read.values[i], map.values[i], 1.0001 / 256);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 3);
}

TEST_F(DisparityFile, IsNotWrittenWhereItCannotHoldTheMap) {
  const auto refused = [&](const std::string& name, const DisparityMap& map) {
    const std::string message =
        test::error_message([&] { write_disparity(folder_.path() / name, map); });
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / name));
    return message;
  };
  EXPECT_NE(refused("a.png", {1, 1, {-0.5f}}).find("-0.5 px as PNG"), std::string::npos);
  EXPECT_NE(refused("a.png", {1, 1, {256.f}}).find("256 px as PNG"), std::string::npos);
  EXPECT_NE(refused("a.tiff", {1, 1, {1.f}}).find("file extension"), std::string::npos);
  EXPECT_NE(refused("a.pfm", {2, 2, {1.f}}).find("does not match"), std::string::npos);
  EXPECT_NE(refused("a.pfm", {}).find("does not match"), std::string::npos);
  EXPECT_NE(refused("no/folder.pfm", {1, 1, {1.f}}).find("cannot be written"), std::string::npos);
}

}  // namespace
}  // namespace vernier
