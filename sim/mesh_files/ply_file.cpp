// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/visibility/convex_pieces.h"

namespace vernier::sim::internal {

using vernier::internal::split_fields;
using vernier::internal::to_real;

namespace {

enum class Kind { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Kind> kind_of(std::string_view word) {
  static const std::map<std::string_view, Kind> kinds{
      {"char", Kind::int8},      {"int8", Kind::int8},       {"uchar", Kind::uint8},
      {"uint8", Kind::uint8},    {"short", Kind::int16},     {"int16", Kind::int16},
      {"ushort", Kind::uint16},  {"uint16", Kind::uint16},   {"int", Kind::int32},
      {"int32", Kind::int32},    {"uint", Kind::uint32},     {"uint32", Kind::uint32},
      {"float", Kind::float32},  {"float32", Kind::float32}, {"double", Kind::float64},
      {"float64", Kind::float64}};
  const auto found = kinds.find(word);
  return found == kinds.end() ? std::nullopt : std::optional(found->second);
}

/// Of a face, and the sum of their squares over the concave faces: cutting one into convex pieces
/// takes the square of its corners, 0.15 s at the most, and 30 s for all.
constexpr std::size_t most_corners = 2000;
constexpr double most_squared_corners = 8e8;

struct Property {
  std::string name;
  Kind kind = Kind::float32;
  std::optional<Kind> count;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

/// The parts of a PLY file in their order.
class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file) : place_(file.string()) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(place_, "cannot be read", "check its permissions");
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
    read_header();
  }

  Mesh mesh() {
    Mesh mesh;
    mesh.format = "PLY";
    for (const Element& element : elements_) {
      if (element.count > most_triangles * 4) {
        fail("has " + std::to_string(element.count) + " of element " + element.name,
             "export fewer details");
      }
      check_size(element);
      if (element.properties.empty()) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        element_ = &element;
        number_ = i;
        read_one(element, mesh);
      }
    }
    add_faces(mesh);
    mesh.step = step_of(mesh);
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& fault, const std::string& remedy) const {
    throw Error(place_, fault, remedy);
  }

  /// Says it of the element that is being read and, in ASCII, of the line of what was read last.
  [[noreturn]] void fail_here(const std::string& fault) const {
    std::string place = place_;
    if (encoding_ == Encoding::ascii) {
      const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
      place += ":" + std::to_string(1 + std::count(bytes_.begin(), end, '\n'));
    }
    throw Error(place, here() + " " + fault, "export it again");
  }

  std::string here() const {
    const bool is_known =
        element_->name == "vertex" || element_->name == "face" || element_->name == "edge";
    return fmt::format("{} {}", is_known ? element_->name : "element", number_);
  }

  std::string_view header_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos || end - at_ > 1000) {
      fail("has no header that ends with end_header", "use a PLY file");
    }
    std::string_view line = std::string_view(bytes_).substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at_ = end + 1;
    return line;
  }

  void read_header() {
    if (bytes_.compare(0, 3, "ply") != 0) fail("does not begin with ply", "use a PLY file");
    header_line();
    bool has_format = false;
    for (std::string_view line = header_line(); line != "end_header"; line = header_line()) {
      const auto words = split_fields(line, " \t");
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info" || words[0].empty())
        continue;
      if (words[0] == "format" && words.size() >= 2) {
        has_format = true;
        if (words[1] == "ascii") {
          encoding_ = Encoding::ascii;
        } else if (words[1] == "binary_little_endian") {
          encoding_ = Encoding::little_endian;
        } else if (words[1] == "binary_big_endian") {
          encoding_ = Encoding::big_endian;
        } else {
          fail("has an unknown format", "use ascii or binary_little_endian");
        }
      } else if (words[0] == "element" && words.size() == 3) {
        const std::optional<double> count = to_real(words[2]);
        if (!count || !(*count >= 0 && *count < 1e12) || *count != std::floor(*count)) {
          fail("has a number of elements that is none", "correct its header");
        }
        elements_.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
      } else if (words[0] == "property" && !elements_.empty()) {
        add_property(words);
      } else {
        fail("has a header line that is not understood", "correct it, or export again");
      }
    }
    if (!has_format) fail("does not say its format", "correct its header");
    for (const Element& element : elements_) {
      if (element.name == "vertex" && !element.properties.empty()) vertex_count_ += element.count;
    }
  }

  void add_property(const std::vector<std::string_view>& words) {
    Property property;
    const bool is_list = words.size() == 5 && words[1] == "list";
    if (words.size() != 3 && !is_list) {
      fail("has a property that is not understood", "correct its header");
    }
    const std::optional<Kind> kind = kind_of(words[is_list ? 3 : 1]);
    if (is_list) property.count = kind_of(words[2]);
    if (!kind || (is_list && !property.count)) {
      fail("has a property that is not understood", "correct its header");
    }
    property.kind = *kind;
    property.name = words.back();
    elements_.back().properties.push_back(property);
  }

  /// Before anything is made of it: the file must be large enough for so many.
  void check_size(const Element& element) const {
    std::uint64_t bytes = 0, axes = 0;
    for (const Property& property : element.properties) {
      // In ASCII a digit and a blank.
      bytes += encoding_ == Encoding::ascii ? 2 : size_of(property.count.value_or(property.kind));
      axes += property.name == "x" || property.name == "y" || property.name == "z";
    }
    if (element.name == "vertex" && axes != 3) {
      fail("has vertices without x, y and z", "export it again");
    }
    // The last number of ASCII may end the file.
    if (element.count * bytes > bytes_.size() - at_ + 1)
      fail("ends too early", "copy or export it again");
  }

  static std::uint64_t size_of(Kind kind) {
    switch (kind) {
      case Kind::int8:
      case Kind::uint8:
        return 1;
      case Kind::int16:
      case Kind::uint16:
        return 2;
      case Kind::int32:
      case Kind::uint32:
      case Kind::float32:
        return 4;
      case Kind::float64:
        return 8;
    }
    return 1;
  }

  double number(Kind kind) {
    if (encoding_ == Encoding::ascii) {
      const std::size_t begin = bytes_.find_first_not_of(" \t\r\n", at_);
      if (begin == std::string::npos) fail("ends too early", "copy or export it again");
      const std::size_t end = std::min(bytes_.find_first_of(" \t\r\n", begin), bytes_.size());
      const std::optional<double> value =
          to_real(std::string_view(bytes_).substr(begin, end - begin));
      at_ = end;
      if (!value) fail_here("has a word where a number belongs");
      return *value;
    }
    switch (kind) {
      case Kind::int8:
        return binary<std::int8_t>();
      case Kind::uint8:
        return binary<std::uint8_t>();
      case Kind::int16:
        return binary<std::int16_t>();
      case Kind::uint16:
        return binary<std::uint16_t>();
      case Kind::int32:
        return binary<std::int32_t>();
      case Kind::uint32:
        return binary<std::uint32_t>();
      case Kind::float32:
        return binary<float>();
      case Kind::float64:
        return binary<double>();
    }
    return 0;
  }

  template <class T>
  double binary() {
    std::array<char, sizeof(T)> raw;
    if (bytes_.size() - at_ < raw.size()) fail("ends too early", "copy or export it again");
    std::memcpy(raw.data(), bytes_.data() + at_, raw.size());
    at_ += raw.size();
    const bool swapped =
        (encoding_ == Encoding::big_endian) == (std::endian::native == std::endian::little);
    if (swapped) std::reverse(raw.begin(), raw.end());
    T value;
    std::memcpy(&value, raw.data(), raw.size());
    return static_cast<double>(value);
  }

  /// Vertices may stand after the faces; how many there are the header says.
  std::uint32_t index(double value) const {
    constexpr double largest = std::numeric_limits<std::uint32_t>::max();
    if (value != std::floor(value)) {
      fail_here(fmt::format("names vertex {:g}, which is no whole number", value));
    }
    if (!(value >= 0 && value < std::min(static_cast<double>(vertex_count_), largest))) {
      fail_here(fmt::format("names vertex {:g}, and there are {}", value, vertex_count_));
    }
    return static_cast<std::uint32_t>(value);
  }

  void read_list(const Element& element, const Property& property) {
    const double count = number(*property.count);
    if (count < 0) fail_here("has a list whose count is negative");
    if (count != std::floor(count)) fail_here("has a list whose count is no whole number");
    if (!(count <= 1e6)) fail_here("has a list too long");
    corners_.clear();
    for (double k = 0; k < count; ++k) corners_.push_back(number(property.kind));
    const bool is_face = element.name == "face" &&
                         (property.name == "vertex_indices" || property.name == "vertex_index");
    if (is_face && corners_.size() > most_corners) {
      fail("has a face of " + std::to_string(corners_.size()) + " corners, " + here(),
           "export it in triangles");
    }
    if (is_face && corners_.size() >= 3) {
      face_sizes_.push_back(static_cast<std::uint32_t>(corners_.size()));
      face_numbers_.push_back(number_);
      for (const double corner : corners_) face_corners_.push_back(index(corner));
    }
    if (face_corners_.size() > 2 * face_sizes_.size() + most_triangles)
      fail("has too many triangles", "export fewer details");
  }

  void read_one(const Element& element, Mesh& mesh) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    std::array<double, 2> ends{-1, -1};
    for (const Property& property : element.properties) {
      if (property.count) {
        read_list(element, property);
        continue;
      }
      const double value = number(property.kind);
      if (element.name == "vertex") {
        for (int axis = 0; axis < 3; ++axis) {
          if (property.name == std::string(1, static_cast<char>('x' + axis))) vertex[axis] = value;
        }
      } else if (element.name == "edge") {
        if (property.name == "vertex1") ends[0] = value;
        if (property.name == "vertex2") ends[1] = value;
      }
    }
    if (element.name == "vertex") {
      if (!vertex.allFinite()) {
        fail(here() + " is not finite", "correct it, or export again");
      }
      mesh.vertices.push_back(vertex);
    } else if (element.name == "edge") {
      mesh.lines.push_back({index(ends[0]), index(ends[1])});
    }
  }

  /// Faces as fans of triangles: of their convex pieces, of which a spike is none; whole without.
  void add_faces(Mesh& mesh) const {
    std::size_t first = 0;
    const auto add_fan = [&](const auto& corner, std::size_t count) {
      for (std::size_t k = 2; k < count; ++k) {
        mesh.triangles.push_back({corner(0), corner(k - 1), corner(k)});
      }
    };
    std::vector<Eigen::Vector3d> polygon;
    double squared_corners = 0;
    for (std::size_t face = 0; face < face_sizes_.size(); ++face) {
      const std::size_t size = face_sizes_[face];
      const auto of_face = [&](std::size_t k) { return face_corners_[first + k]; };
      polygon.clear();
      for (std::size_t k = 0; size > 3 && k < size; ++k) {
        polygon.push_back(mesh.vertices[of_face(k)]);
      }
      std::vector<std::vector<int>> pieces;
      if (size > 3) pieces = convex_pieces(polygon);
      if (pieces.size() > 1) squared_corners += static_cast<double>(size * size);
      if (squared_corners > most_squared_corners) {
        fail(fmt::format("has too many corners in concave faces, up to face {}",
                         face_numbers_[face]),
             "export it in triangles");
      }
      if (pieces.empty()) add_fan(of_face, size);
      for (const std::vector<int>& piece : pieces) {
        add_fan([&](std::size_t k) { return of_face(static_cast<std::size_t>(piece[k])); },
                piece.size());
      }
      first += size;
    }
  }

  /// To which coordinates are rounded that stand as floats in binary; ASCII has its own digits.
  double step_of(const Mesh& mesh) const {
    if (encoding_ == Encoding::ascii) return 0;
    double largest = 0;
    for (const Element& element : elements_) {
      for (const Property& property : element.properties) {
        if (element.name != "vertex" || property.kind != Kind::float32) continue;
        if (property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z') continue;
        const int axis = property.name[0] - 'x';
        for (const Eigen::Vector3d& v : mesh.vertices)
          largest = std::max(largest, std::abs(v[axis]));
      }
    }
    return largest * std::numeric_limits<float>::epsilon();
  }

  std::string place_, bytes_;
  std::size_t at_ = 0;
  Encoding encoding_ = Encoding::ascii;
  std::vector<Element> elements_;
  std::vector<double> corners_;                           // of a list
  std::vector<std::uint32_t> face_sizes_, face_corners_;  // of all faces, one after the other
  std::vector<std::uint64_t> face_numbers_;
  std::uint64_t vertex_count_ = 0;
  const Element* element_ = nullptr;  // that is being read, and which of them
  std::uint64_t number_ = 0;
};

}  // namespace

Mesh read_ply(const std::filesystem::path& file) { return PlyReader(file).mesh(); }

}  // namespace vernier::sim::internal
