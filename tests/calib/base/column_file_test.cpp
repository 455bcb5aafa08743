// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/column_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/byte_order.h"
#include "calib/base/file_in_progress.h"
#include "calib/error.h"

namespace vernier {

using namespace vernier::internal;

namespace {

const std::vector<Column> columns{{"n", ColumnKind::whole},
                                  {"x, m", ColumnKind::real},
                                  {"ok", ColumnKind::boolean},
                                  {"what", ColumnKind::text, 4}};

const std::vector<std::vector<ColumnValue>> rows{
    {std::int64_t{-3}, 0.1, true, std::string("ψ_c")},
    {std::int64_t{4}, std::nan(""), false, std::string("a \"b\", c")}};

std::string written(ColumnFile::Format format) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "column_file_test.out";
  FileInProgress file(path);
  ColumnFile table(file, format, columns, rows.size());
  for (const auto& row : rows) table.add(row);
  file.commit();
  return read_whole(path);
}

TEST(ColumnFile, CsvQuotesWhatItMustAndLeavesMissingNumbersEmpty) {
  EXPECT_EQ(written(ColumnFile::Format::csv),
            "n,\"x, m\",ok,what\n-3,0.1,true,ψ_c\n4,,false,\"a \"\"b\"\", c\"\n");
}

TEST(ColumnFile, NpyIsAStructuredArray) {
  const std::string bytes = written(ColumnFile::Format::npy);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t head = 10 + number_at<std::uint16_t>(bytes, 8, false);
  EXPECT_EQ(head % 64, 0u);
  EXPECT_NE(bytes.find("{'descr': [('n', '<i8'), ('x, m', '<f8'), ('ok', '|b1'), ('what', '<U4'), ]"
                       ", 'fortran_order': False, 'shape': (2,), }"),
            std::string::npos);
  constexpr std::size_t row = 8 + 8 + 1 + 16;
  ASSERT_EQ(bytes.size(), head + 2 * row);
  EXPECT_EQ(number_at<std::int64_t>(bytes, head, false), -3);
  EXPECT_EQ(number_at<double>(bytes, head + 8, false), 0.1);
  EXPECT_EQ(bytes[head + 16], 1);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, head + 17, false), 0x3c8u);  // ψ
  EXPECT_EQ(number_at<std::uint32_t>(bytes, head + 29, false), 0u);
  EXPECT_TRUE(std::isnan(number_at<double>(bytes, head + row + 8, false)));
  EXPECT_EQ(number_at<std::uint32_t>(bytes, head + row + 29, false), std::uint32_t{'b'});  // cut
}

TEST(ColumnFile, RefusesRowsThatDoNotFit) {
  FileInProgress file(std::filesystem::path(testing::TempDir()) / "column_file_test.none");
  ColumnFile table(file, ColumnFile::Format::csv, columns, 1);
  EXPECT_THROW(table.add({std::int64_t{1}, 2.0, true}), Error);
  EXPECT_THROW(table.add({1.0, 2.0, true, std::string()}), Error);
  EXPECT_THROW(ColumnFile::format_of("results.xlsx"), Error);
}

}  // namespace
}  // namespace vernier
