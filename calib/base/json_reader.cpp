// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/json_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/base/utf8.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// A byte of the text, which says how far the parser has read.
class ReadByte {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  ReadByte(const char* byte, const char** read) : byte_(byte), read_(read) {}

  reference operator*() const { return *byte_; }
  ReadByte& operator++() {
    *read_ = ++byte_;
    return *this;
  }
  ReadByte operator++(int) {
    const ReadByte before = *this;
    ++*this;
    return before;
  }
  bool operator==(const ReadByte& other) const { return byte_ == other.byte_; }
  bool operator!=(const ReadByte& other) const { return byte_ != other.byte_; }

 private:
  const char* byte_;
  const char** read_;
};

/// Builds the value, and throws at the first fault.
class JsonBuilder {
 public:
  using number_integer_t = OrderedJson::number_integer_t;
  using number_unsigned_t = OrderedJson::number_unsigned_t;
  using number_float_t = OrderedJson::number_float_t;
  using string_t = OrderedJson::string_t;
  using binary_t = OrderedJson::binary_t;

  /// With `is_line`, messages name the column.
  JsonBuilder(std::string_view text,
              const std::string& place,
              const JsonLimits& limits,
              bool is_line)
      : text_(text), place_(place), limits_(limits), is_line_(is_line), read_(text.data()) {}

  OrderedJson build() {
    const char* end = text_.data() + text_.size();
    OrderedJson::sax_parse(ReadByte(text_.data(), &read_), ReadByte(end, &read_), this);
    return std::move(root_);
  }

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(number_integer_t value) { return add(value); }
  bool number_unsigned(number_unsigned_t value) { return add(value); }
  bool number_float(number_float_t value, const string_t& digits) {
    if (digits.size() > limits_.number_digits) {
      fail(fmt::format("holds a number of {} digits, and {} are allowed", digits.size(),
                       limits_.number_digits),
           "shorten it");
    }
    return add(value);
  }
  bool string(string_t& value) {
    check_length(value, "a text");
    return add(std::move(value));
  }
  bool binary(binary_t&) { fail("holds binary data", ""); }

  bool start_object(std::size_t) { return open(OrderedJson::object()); }
  bool start_array(std::size_t) { return open(OrderedJson::array()); }

  bool key(string_t& name) {
    check_length(name, "a key");
    auto& object = open_.back()->get_ref<OrderedJson::object_t&>();
    if (object.size() >= limits_.keys) {
      fail(fmt::format("holds an object of more than {} keys", limits_.keys), "use a list");
    }
    // ordered_map::emplace would look through all keys before.
    object.emplace_back(std::move(name), OrderedJson());
    return true;
  }

  bool end_object() {
    const auto& object = open_.back()->get_ref<const OrderedJson::object_t&>();
    names_.clear();
    for (const auto& [name, value] : object) names_.push_back(&name);
    const auto less = [](const auto* a, const auto* b) { return *a < *b; };
    const auto same = [](const auto* a, const auto* b) { return *a == *b; };
    std::sort(names_.begin(), names_.end(), less);
    const auto twice = std::adjacent_find(names_.begin(), names_.end(), same);
    if (twice != names_.end()) {
      fail("the object that ends here has the key " + in_quotes(**twice) + " twice", "keep one");
    }
    open_.pop_back();
    return true;
  }

  bool end_array() {
    open_.pop_back();
    return true;
  }

  bool parse_error(std::size_t, const std::string& token, const OrderedJson::exception& fault) {
    constexpr int number_too_large = 406;
    if (fault.id == number_too_large) {
      fail(in_quotes(token) + " is not a number that a double can hold", "correct it");
    }
    if (is_no_number()) {
      fail("holds NaN or Infinity, which JSON does not have", "leave the value out");
    }
    if (is_cut(fault.what())) fail("is not JSON: it ends too early", "write it again");
    fail("is not JSON: a comma, quote or bracket is wrong here", "correct it");
  }

 private:
  static bool is_cut(const std::string& fault) {
    return fault.find("unexpected end of input") != std::string::npos ||
           fault.find("missing closing quote") != std::string::npos;
  }

  /// Whether the parser has stopped in NaN or Infinity, as other languages write them.
  bool is_no_number() const {
    const auto byte = static_cast<std::size_t>(read_ - text_.data());
    const std::string_view around = text_.substr(byte > 3 ? byte - 3 : 0, 6);
    return std::ranges::any_of(std::array{"NaN", "nan", "Inf", "inf"}, [&](const char* word) {
      return around.find(word) != std::string_view::npos;
    });
  }

  [[noreturn]] void fail(const std::string& fault, const std::string& remedy) const {
    const auto byte = static_cast<std::size_t>(read_ - text_.data());
    // The parser has read a character beyond what it complains about.
    const std::size_t at = byte > 0 ? byte - 1 : 0;
    throw Error(fmt::format("{}:{}", place_, is_line_ ? at + 1 : line_of(text_, at)), fault,
                remedy);
  }

  void check_length(const std::string& value, const char* what) const {
    if (value.size() <= limits_.text_bytes) return;
    fail(fmt::format("holds {} of {} bytes, and {} are allowed", what, value.size(),
                     limits_.text_bytes),
         "shorten it");
  }

  /// Where the next value goes.
  OrderedJson& place_for_value() {
    if (++values_ > limits_.values) {
      fail(fmt::format("holds more than {} values", limits_.values), "split the file");
    }
    if (open_.empty()) return root_;
    if (open_.back()->is_object()) {
      return open_.back()->get_ref<OrderedJson::object_t&>().back().second;
    }
    return open_.back()->get_ref<OrderedJson::array_t&>().emplace_back();
  }

  template <class Value>
  bool add(Value&& value) {
    place_for_value() = OrderedJson(std::forward<Value>(value));
    return true;
  }

  bool open(OrderedJson container) {
    if (open_.size() >= limits_.depth) {
      fail(fmt::format("is nested more than {} levels deep", limits_.depth),
           "name another file, or flatten it");
    }
    OrderedJson& value = place_for_value();
    value = std::move(container);
    open_.push_back(&value);
    return true;
  }

  std::string_view text_;
  const std::string& place_;
  const JsonLimits& limits_;
  bool is_line_;
  const char* read_;
  OrderedJson root_;
  std::vector<OrderedJson*> open_;  ///< the lists and objects that are not closed yet
  std::vector<const std::string*> names_;
  std::size_t values_ = 0;
};

}  // namespace

namespace {

nlohmann::ordered_json parse(std::string_view text,
                             const std::string& place,
                             const JsonLimits& limits,
                             bool is_line) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw Error(place, "is empty", "write it again, or name another file");
  }
  check_text(text, place, "a JSON file", limits.bytes);
  return JsonBuilder(text, place, limits, is_line).build();
}

}  // namespace

nlohmann::ordered_json parse_json(std::string_view text,
                                  const std::string& place,
                                  const JsonLimits& limits) {
  return parse(text, place, limits, false);
}

nlohmann::ordered_json parse_json_line(std::string_view line,
                                       const std::string& place,
                                       const JsonLimits& limits) {
  return parse(line, place, limits, true);
}

}  // namespace vernier::internal
