// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world/written_rows.h"

#include <Eigen/Core>
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "sim/world.h"
#include "sim/world/world_check.h"
#include "sim/world/world_limits.h"

namespace vernier::sim::internal {

using vernier::internal::is_digit;

namespace {

constexpr std::size_t worth_it_bytes = 1'000'000;

/// Reads a line from its front; each call says whether the expected stood there.
class Row {
 public:
  explicit Row(std::string_view text) : text_(text) {}

  bool take(std::string_view word) {
    if (!text_.starts_with(word)) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  bool at(std::string_view word) const { return text_.starts_with(word); }
  bool done() const { return text_.empty(); }

  /// A number of TOML in plain form: a minus, digits without a leading zero, a fraction.
  bool take(double& number) {
    std::size_t end = at("-") ? 1 : 0;
    const std::size_t whole = end;
    while (end < text_.size() && is_digit(text_[end])) ++end;
    if (end == whole || (text_[whole] == '0' && end > whole + 1)) return false;
    if (end < text_.size() && text_[end] == '.') {
      const std::size_t fraction = ++end;
      while (end < text_.size() && is_digit(text_[end])) ++end;
      if (end == fraction) return false;
    }
    constexpr std::size_t longest = 18;  // so that a whole number is one that TOML holds
    if (end - whole > longest) return false;
    std::from_chars(text_.data(), text_.data() + end, number);
    text_.remove_prefix(end);
    return true;
  }
  bool take(Eigen::Vector3d& point) {
    return take(point.x()) && take(", ") && take(point.y()) && take(", ") && take(point.z());
  }

 private:
  std::string_view text_;
};

bool take_segment(std::string_view line, FeatureSet& into) {
  Row row(line);
  Eigen::Vector3d a, b;
  if (!(row.take("  [") && row.take(a) && row.take(", ") && row.take(b) && row.take("],")) ||
      !row.done() || segment_error(a, b)) {
    return false;
  }
  into.segments_m.emplace_back(a, b);
  return true;
}

bool take_corner(std::string_view line, FeatureSet& into) {
  Row row(line);
  Eigen::Vector3d at;
  if (!(row.take("  [") && row.take(at) && row.take("],")) || !row.done() || point_error(at)) {
    return false;
  }
  into.corners_m.push_back(at);
  return true;
}

bool take_surface(std::string_view line, FeatureSet& into) {
  Row row(line);
  std::vector<Eigen::Vector3d> polygon;
  if (!row.take("  [")) return false;
  do {
    Eigen::Vector3d point;
    if (!(row.take("[") && row.take(point) && row.take("]"))) return false;
    polygon.push_back(point);
  } while (row.take(", "));
  if (!row.take("],") || !row.done() || surface_error(polygon)) return false;
  into.surfaces_m.push_back(std::move(polygon));
  return true;
}

using TakeRow = bool (*)(std::string_view line, FeatureSet& into);

/// How the rows of a list are read that begins with this line; null for any other line.
TakeRow list_that_begins(std::string_view line) {
  if (line == "segments = [") return take_segment;
  if (line == "corners = [") return take_corner;
  if (line == "surfaces = [") return take_surface;
  return nullptr;
}

bool too_many(const FeatureSet& features) {
  return features.segments_m.size() > most_features || features.corners_m.size() > most_features ||
         features.surfaces_m.size() > most_features;
}

}  // namespace

std::optional<WrittenRows> take_written_rows(const std::string& text) {
  if (text.size() < worth_it_bytes || text.find("\"\"\"") != std::string::npos ||
      text.find("'''") != std::string::npos) {
    return std::nullopt;
  }
  const std::string_view whole = text;
  const std::size_t header = whole.find("\n[loose]\n");
  if (header == std::string_view::npos) return std::nullopt;
  WrittenRows taken;
  std::size_t at = header + std::string_view("\n[loose]\n").size();
  taken.rest = whole.substr(0, at);
  TakeRow take = nullptr;
  bool in_loose = true;
  while (at < whole.size()) {
    const std::size_t end = std::min(whole.find('\n', at), whole.size());
    const std::string_view line = whole.substr(at, end - at);
    at = end + 1;
    if (take && line != "]") {
      if (!take(line, taken.features) || too_many(taken.features)) return std::nullopt;
      taken.rest += '\n';
      continue;
    }
    if (!take && line.starts_with("[")) in_loose = false;
    take = in_loose && !take ? list_that_begins(line) : nullptr;
    taken.rest += line;
    taken.rest += '\n';
  }
  return taken;
}

}  // namespace vernier::sim::internal
