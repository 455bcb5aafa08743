// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/pairs_file.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/pair_observations.h"

namespace vernier::internal {
namespace {

constexpr std::string_view header = "pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px";

void read_row(std::string_view line,
              const TextLines& lines,
              std::set<int>& seen,
              PairObservations& pairs) {
  const std::vector<std::string_view> fields = split_fields(line, ",");
  if (fields.size() != 6) {
    throw Error(lines.place(), fmt::format("{} fields where 6 are expected", fields.size()),
                fmt::format("a line is {}", header));
  }
  const int number = parse_whole(fields[0], lines.place(), "pair");
  Eigen::Vector4d y;
  for (int i = 0; i < 4; ++i) {
    y[i] = parse_real(fields[static_cast<std::size_t>(i + 1)], lines.place(), "a pixel coordinate");
  }
  const double sigma = parse_real(fields[5], lines.place(), "sigma_px");
  if (!y.allFinite()) {
    throw Error(lines.place(), "a pixel coordinate is not finite", "remove the line");
  }
  constexpr double most = 1e6;                              // px
  if (!(static_cast<float>(sigma) > 0 && sigma <= most)) {  // it is kept as a float
    throw Error(lines.place(), fmt::format("sigma_px is {}", sigma),
                "give a standard deviation above 0 and below a million");
  }
  const bool known = !pairs.image_pairs.empty() && pairs.image_pairs.back().number == number;
  if (number < 0 || (!known && !seen.insert(number).second)) {
    throw Error(lines.place(),
                number < 0 ? fmt::format("pair is {}", number)
                           : fmt::format("image pair {} appears a second time", number),
                number < 0 ? "number image pairs from 0" : "keep its lines together");
  }
  add_pair(pairs, number, y, sigma);
}

}  // namespace

PairObservations read_pairs(const std::filesystem::path& file) {
  TextLines lines(file);
  std::string_view line;
  const bool any = lines.next(line);
  if (any && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // byte order mark
  if (!any || line != header) {
    throw Error(file.string() + ":1", "it has no header of a pairs file",
                fmt::format("its first line must be {}", header));
  }
  PairObservations pairs;
  pairs.pixels_px.reserve(lines.size() / 60);
  std::set<int> seen;
  while (lines.next(line)) read_row(line, lines, seen, pairs);
  if (pairs.size() == 0)
    throw Error(file.string(), "it contains no pair", "match at least one corner");
  return pairs;
}

std::string format_pairs(const PairObservations& pairs) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n", header);
  for (const ImagePair& image : pairs.image_pairs) {
    for (std::size_t i = image.first; i < image.first + image.count; ++i) {
      const Eigen::Vector4d& y = pairs.pixels_px[i];
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}\n", image.number, y[0], y[1],
                     y[2], y[3], static_cast<float>(pairs.sigma_of(i)));
    }
  }
  return fmt::to_string(text);
}

void write_pairs(const PairObservations& pairs, const std::filesystem::path& file) {
  write_atomically(file, format_pairs(pairs));
}

}  // namespace vernier::internal
