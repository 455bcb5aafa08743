// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "calib/error.h"

/// Fuzz targets: one a reader. A target gives any bytes to its reader, which may refuse them with
/// vernier::Error and nothing else. Where there is a writer, what was read must survive it: reading
/// what was written gives the same values. The same functions run under libFuzzer
/// (scripts/fuzz.sh) and, on the kept inputs, in the unit tests (tests/corpus).
namespace vernier::fuzz {

struct Target {
  const char* name;
  std::size_t max_bytes;   ///< longest input worth trying
  const char* dictionary;  ///< fuzz/dictionaries/NAME.dict; empty: none
  void (*run)(std::string_view bytes);
  std::vector<std::string> (*seeds)();  ///< made by the program's own writers where there are any
};

/// All targets that are linked, in alphabetical order.
std::vector<Target> targets();

/// Adds a target to that list: one static object a target.
class Registered {
 public:
  explicit Registered(const Target& target);
};

/// A property that does not hold. Never caught by a target.
class Finding : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void require(bool holds, const std::string& property) {
  if (!holds) throw Finding("does not hold: " + property);
}

/// The promises about messages: one line that says where, without control characters, and short.
void check_message(const Error& error);

/// What `read` returns, or nothing if it refuses with an Error.
template <typename Read>
auto accepted(const Read& read) -> std::optional<std::invoke_result_t<Read>> {
  try {
    return read();
  } catch (const Error& error) {
    check_message(error);
    return std::nullopt;
  }
}

/// A file of this process in the temporary folder, overwritten by the next of the same name.
std::filesystem::path input_file(std::string_view bytes, const std::string& name);

/// The folder of these files; emptied with `clear`.
std::filesystem::path input_folder();
void clear_input_folder();

/// The bytes of a file of that folder, such as a writer has written.
std::string file_bytes(const std::filesystem::path& file);

/// The line that parts the files of a pair in one input.
inline constexpr std::string_view right_file = "---";

/// The bytes up to the first line that is `separator`, and those behind it.
std::pair<std::string_view, std::string_view> split_at_line(std::string_view bytes,
                                                            std::string_view separator);

}  // namespace vernier::fuzz
