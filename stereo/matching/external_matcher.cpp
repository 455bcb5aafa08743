// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/external_matcher.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/image_file.h"
#include "calib/base/program_run.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"
#include "stereo/matching/matcher_input.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 4> outputs = {
    {{"{output}", "output.pfm"},
     {"{output.pfm}", "output.pfm"},
     {"{output.png}", "output.png"},
     {"{output.npy}", "output.npy"}}};

std::vector<std::string> known_placeholders() {
  std::vector<std::string> known{"{left}", "{right}", "{least}", "{most}"};
  for (const auto& [placeholder, file] : outputs) known.emplace_back(placeholder);
  return known;
}

/// Throws Error for a {name} that is replaced by nothing, in a word without blanks: others are
/// scripts, which have braces of their own.
void check_placeholders(const std::string& word, const std::string& place) {
  const auto is_in_name = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '.';
  };
  if (std::any_of(word.begin(), word.end(), [](unsigned char c) { return std::isspace(c) != 0; }))
    return;
  for (std::size_t at = word.find('{'); at != std::string::npos; at = word.find('{', at + 1)) {
    std::size_t end = at + 1;
    while (end < word.size() && is_in_name(static_cast<unsigned char>(word[end]))) ++end;
    const bool is_of_shell = at > 0 && word[at - 1] == '$';
    if (is_of_shell || end == at + 1 || end == word.size() || word[end] != '}') continue;
    const std::string name = word.substr(at, end + 1 - at);
    const std::vector<std::string> known = known_placeholders();
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(place, "has the unknown placeholder " + in_quotes(name),
                "use " + alternatives(known) + "; braces of your own need a blank in their word");
  }
}

/// A command split into words, and the name of the map that it writes.
struct Command {
  std::string place;  ///< used in error messages
  std::vector<std::string> words;
  std::string output;
};

Command parse_command(const std::string& command) {
  Command parsed;
  parsed.place = "matcher '" + command + "'";
  std::replace_if(
      parsed.place.begin(), parsed.place.end(),
      [](unsigned char letter) { return std::iscntrl(letter) != 0; }, ' ');
  parsed.words = command_words(command, parsed.place);
  if (parsed.words.empty()) throw Error("matcher", "the command is empty", "give a program");
  for (const std::string& word : parsed.words) check_placeholders(word, parsed.place);
  for (const char* needed : {"{left}", "{right}"}) {
    if (command.find(needed) == std::string::npos) {
      throw Error(parsed.place, std::string("has no ") + needed,
                  "add it where the program expects the image");
    }
  }
  for (const auto& [placeholder, file] : outputs) {
    if (command.find(placeholder) == std::string::npos) continue;
    if (!parsed.output.empty() && parsed.output != file) {
      throw Error(parsed.place, "has {output} in two formats", "use one");
    }
    parsed.output = file;
  }
  if (parsed.output.empty()) {
    throw Error(parsed.place, "has no {output}",
                "add it where the program expects the output file");
  }
  return parsed;
}

using Values = std::vector<std::pair<std::string_view, std::string>>;

/// In a single pass: inserted values may look like placeholders themselves.
std::string filled(std::string_view word, const Values& values) {
  std::string text;
  while (!word.empty()) {
    const auto value = std::find_if(values.begin(), values.end(), [&](const auto& candidate) {
      return word.substr(0, candidate.first.size()) == candidate.first;
    });
    if (value == values.end()) {
      text += word[0];
      word.remove_prefix(1);
    } else {
      text += value->second;
      word.remove_prefix(value->first.size());
    }
  }
  return text;
}

std::vector<std::string> filled(const Command& command,
                                const fs::path& folder,
                                const DisparityRange& range) {
  Values values = {{"{left}", (folder / "left.png").string()},
                   {"{right}", (folder / "right.png").string()},
                   {"{least}", std::to_string(range.min_px)},
                   {"{most}", std::to_string(range.max_px)}};
  for (const auto& [placeholder, file] : outputs) {
    values.emplace_back(placeholder, (folder / file).string());
  }
  std::vector<std::string> words;
  for (const std::string& word : command.words) words.push_back(filled(word, values));
  return words;
}

void write_image(const TemporaryFolder& folder, const std::string& name, const GreyLevels& grey) {
  folder.write(name, internal::png_of(bytes_of(grey)));
}

/// Throws Error for a program that failed.
void check_run(const ProgramRun& run, const Command& command, double time_limit_s) {
  std::string fault;
  if (run.start_error == ENOENT) {
    fault = "program '" + command.words[0] + "' not found";
  } else if (run.start_error) {
    fault = "program '" + command.words[0] +
            "' cannot be run: " + std::generic_category().message(run.start_error);
  } else if (run.timed_out) {
    fault = fmt::format("exceeded the time limit of {} s and was stopped", time_limit_s);
  } else if (run.signal) {
    fault = fmt::format("was terminated by signal {}: {}", run.signal, run.last_output_line());
  } else if (run.exit_code != 0) {
    fault = fmt::format("exited with status {}: {}", run.exit_code, run.last_output_line());
  }
  if (!fault.empty()) throw Error(command.place, fault, "try the command in a shell");
}

/// Reads the program's map; errors refer to the program.
DisparityMap read_output(const fs::path& file,
                         const Command& command,
                         const DisparityRange& range,
                         double scale) {
  if (!fs::is_regular_file(file)) {
    throw Error(command.place, "exited with status 0 but wrote no file to {output}",
                "make it write its map to {output}");
  }
  try {
    const std::string bytes = read_whole(file);
    const bool is_deep = is_png(bytes) && largest_grey_value(bytes) == 65535;
    if (scale == 0) scale = is_deep ? 256 : 1;
    DisparityFileOptions options;
    options.scale = scale;
    options.min_px = range.min_px - 0.5;
    return read_disparity(file, options);
  } catch (const Error& error) {
    std::string place = error.place();
    const std::string folder = (file.parent_path() / "").string();
    if (place.rfind(folder, 0) == 0) place.erase(0, folder.size());
    throw Error(command.place, place + ": " + error.fault(), error.remedy());
  }
}

/// Sets disparities above the range to unknown.
MapRange cut_above(DisparityMap& map, const DisparityRange& range) {
  MapRange counted;
  for (float& d : map.values) {
    if (!(d == d)) continue;
    const bool above = !(d < static_cast<float>(range.max_px) + 0.5F);
    if (above) d = std::numeric_limits<float>::quiet_NaN();
    ++(above ? counted.above : counted.within);
  }
  return counted;
}

DisparityMap run(const Command& command,
                 const RectifiedPair& pair,
                 const DisparityRange& range,
                 const ExternalMatcherOptions& options) {
  check_matcher_input(pair, range, command.place);
  if (range.min_px < 0 && command.output == "output.png") {
    throw Error(command.place,
                fmt::format("a PNG cannot hold the disparities below 0 of a range from {} px",
                            range.min_px),
                "use {output} or {output.npy}");
  }
  const TemporaryFolder folder;
  write_image(folder, "left.png", pair.left);
  write_image(folder, "right.png", pair.right);
  check_run(run_program(filled(command, folder.path(), range), options.time_limit_s), command,
            options.time_limit_s);
  DisparityMap map = read_output(folder.path() / command.output, command, range, options.scale);
  if (map.width_px != pair.left.width_px || map.height_px != pair.left.height_px) {
    throw Error(command.place,
                fmt::format("wrote a map of {}x{} for images of {}x{}", map.width_px, map.height_px,
                            pair.left.width_px, pair.left.height_px),
                "make it write one disparity per pixel of the left image");
  }
  const MapRange counted = cut_above(map, range);
  if (options.told) options.told(counted);
  return map;
}

}  // namespace

Matcher external_matcher(const std::string& command, const ExternalMatcherOptions& options) {
  const Command parsed = parse_command(command);
  Matcher matcher;
  matcher.name =
      options.name.empty() ? fs::path(parsed.words[0]).filename().string() : options.name;
  matcher.match = [parsed, options](const auto& pair, const auto& edges, const auto& range) {
    return sample_at_edges(run(parsed, pair, range, options), edges, options.sampling);
  };
  return matcher;
}

DisparityMap external_map(const RectifiedPair& pair,
                          const DisparityRange& range,
                          const std::string& command,
                          const ExternalMatcherOptions& options) {
  return run(parse_command(command), pair, range, options);
}

}  // namespace vernier::stereo::internal
