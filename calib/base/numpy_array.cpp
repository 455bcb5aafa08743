// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/numpy_array.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "calib/base/byte_order.h"
#include "calib/base/image_size.h"
#include "calib/base/python_literal.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr std::string_view magic{"\x93NUMPY", 6};
constexpr double max_side = 1 << 20;

/// The header of a .npy file and the offset of its data.
struct Head {
  std::string type;
  bool column_major = false;
  std::size_t rows = 0, columns = 0;
  std::size_t data_at = 0;
};

/// The dictionary that describes the array.
PythonLiteral description(std::string_view bytes, const std::string& place, std::size_t& data_at) {
  const Error cut(place, "is cut off in its NumPy header", "write it again");
  if (bytes.size() < 10) throw cut;
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3) {
    throw Error(place, fmt::format("has version {} of NumPy's format", version),
                "write it with numpy.save");
  }
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  data_at = 8 + length_bytes;
  if (bytes.size() < data_at) throw cut;
  const std::size_t length = version == 1 ? number_at<std::uint16_t>(bytes, 8, false)
                                          : number_at<std::uint32_t>(bytes, 8, false);
  if (bytes.size() - data_at < length) throw cut;
  const std::string_view text = bytes.substr(data_at, length);
  data_at += length;
  return parse_python_literal(text, place);
}

std::size_t side_of(const PythonLiteral& side, const std::string& place) {
  const double length = side.number;
  if (side.kind != PythonLiteral::Kind::number || !(length >= 1 && length <= max_side) ||
      length != std::floor(length)) {
    throw Error(place, "has a dimension of " + side.text, "give an array of image size");
  }
  return static_cast<std::size_t>(length);
}

Head head_of(std::string_view bytes, const std::string& place) {
  Head head;
  const PythonLiteral header = description(bytes, place, head.data_at);
  const PythonLiteral* type = header.find("descr");
  const PythonLiteral* order = header.find("fortran_order");
  const PythonLiteral* shape = header.find("shape");
  if (!type || !order || !shape) {
    throw Error(place, "has a NumPy header without descr, fortran_order or shape",
                "write it with numpy.save");
  }
  if (order->text != "False") {
    throw Error(place, "is in Fortran (column-major) order", "save numpy.ascontiguousarray of it");
  }
  if (shape->items.size() != 2) {
    throw Error(place, fmt::format("has {} dimensions, not 2", shape->items.size()),
                "save an array of shape (height, width)");
  }
  head.type = type->kind == PythonLiteral::Kind::text ? type->text : "of a structure";
  head.rows = side_of(shape->items[0], place);
  head.columns = side_of(shape->items[1], place);
  if (const std::string fault = size_fault({head.columns, head.rows}); !fault.empty()) {
    throw Error(place, fault, "give an array of image size");
  }
  return head;
}

template <typename Value>
std::vector<double> decode(std::string_view data, std::size_t count, bool big_endian) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = static_cast<double>(number_at<Value>(data, i * sizeof(Value), big_endian));
  }
  return values;
}

using Decode = std::vector<double> (*)(std::string_view, std::size_t, bool);

/// The decoder for numbers of a kind (f, i, u) and size in bytes; null if unsupported.
Decode decoder(std::string_view type) {
  if (type == "f4") return decode<float>;
  if (type == "f8") return decode<double>;
  if (type == "u1") return decode<std::uint8_t>;
  if (type == "u2") return decode<std::uint16_t>;
  if (type == "u4") return decode<std::uint32_t>;
  if (type == "u8") return decode<std::uint64_t>;
  if (type == "i1") return decode<std::int8_t>;
  if (type == "i2") return decode<std::int16_t>;
  if (type == "i4") return decode<std::int32_t>;
  if (type == "i8") return decode<std::int64_t>;
  return nullptr;
}

}  // namespace

bool is_numpy(std::string_view bytes) { return bytes.substr(0, magic.size()) == magic; }

NumpyArray parse_numpy(std::string_view bytes, const std::string& place) {
  const Head head = head_of(bytes, place);
  const bool marked = head.type.size() == 3 && std::string_view("<>|=").find(head.type[0]) <= 3;
  const Decode read = marked ? decoder(head.type.substr(1)) : nullptr;
  if (!read) {
    throw Error(place, "has the data type " + head.type,
                "supported: float32, float64 and integers of 1 to 8 bytes");
  }
  const std::size_t count = head.rows * head.columns;
  const std::size_t wanted = count * static_cast<std::size_t>(head.type[2] - '0');
  const std::string_view data = bytes.substr(head.data_at);
  if (data.size() != wanted) {
    throw Error(place,
                fmt::format("has {} bytes of values, {} than the {} for {} x {} of type {}",
                            data.size(), data.size() < wanted ? "fewer" : "more", wanted, head.rows,
                            head.columns, head.type),
                "write it again");
  }
  return {head.rows, head.columns, head.type[1] != 'f', read(data, count, head.type[0] == '>')};
}

std::string numpy_head(std::string dictionary) {
  constexpr std::size_t aligned = 64;
  const bool is_ascii = std::all_of(dictionary.begin(), dictionary.end(),
                                    [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  const bool is_short =
      is_ascii && dictionary.size() + aligned < std::numeric_limits<std::uint16_t>::max();
  const std::size_t before = is_short ? 10 : 12;
  dictionary.append(aligned - (before + dictionary.size() + 1) % aligned, ' ');
  dictionary += '\n';
  std::string bytes(magic);
  bytes += is_short ? std::string_view("\x01\x00", 2) : std::string_view("\x03\x00", 2);
  if (is_short) {
    append_number(bytes, static_cast<std::uint16_t>(dictionary.size()), false);
  } else {
    append_number(bytes, static_cast<std::uint32_t>(dictionary.size()), false);
  }
  return bytes + dictionary;
}

std::string numpy_bytes(const std::vector<float>& values, int rows, int columns) {
  std::string bytes = numpy_head(fmt::format(
      "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", rows, columns));
  for (const float value : values) append_number(bytes, value, false);
  return bytes;
}

}  // namespace vernier::internal
