// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/ifc_unit.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/small_letters.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"

namespace vernier::sim::internal {

using vernier::internal::small_letters;

namespace {

constexpr std::string_view ifc_blanks = " \t\r\n";

/// Without blanks around it.
std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(ifc_blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(ifc_blanks) + 1 - begin);
}

/// The text with blanks in place of its comments.
std::string without_comments(std::string_view text) {
  std::string plain(text);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    std::size_t end = i;
    if (plain[i] == '\'') {
      end = plain.find('\'', i + 1);  // a quote in a string is doubled: two strings, to this end
    } else if (plain.compare(i, 2, "/*") == 0) {
      const std::size_t last = plain.find("*/", i + 2);
      end = last == std::string::npos ? plain.size() : last + 1;
      std::fill(plain.begin() + static_cast<std::ptrdiff_t>(i),
                plain.begin() + static_cast<std::ptrdiff_t>(std::min(end + 1, plain.size())), ' ');
    }
    if (end == std::string::npos) break;
    i = end;
  }
  return plain;
}

/// Calls visit(position) for the bytes of a text without comments that stand in no string.
template <class Visit>
void visit_code(std::string_view text, Visit visit) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\'') {
      i = text.find('\'', i + 1);
    } else {
      visit(i);
    }
    if (i == std::string_view::npos) return;
  }
}

/// What commas separate, outside of parentheses.
std::vector<std::string_view> arguments_of(std::string_view text) {
  std::vector<std::string_view> arguments;
  std::size_t begin = 0;
  int depth = 0;
  visit_code(text, [&](std::size_t i) {
    depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
    if (text[i] != ',' || depth != 0) return;
    arguments.push_back(trimmed(text.substr(begin, i - begin)));
    begin = i + 1;
  });
  arguments.push_back(trimmed(text.substr(begin)));
  return arguments;
}

/// What stands between the first parenthesis and the last; all of it without any.
std::string_view inside_parentheses(std::string_view text) {
  const std::size_t begin = text.find('('), end = text.rfind(')');
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return text;
  return text.substr(begin + 1, end - begin - 1);
}

struct Entity {
  std::string type;  // in small letters
  std::vector<std::string_view> arguments;
};

/// The entities by their names, such as #12, that say something of units.
std::map<std::string_view, Entity> entities_of_units(std::string_view text) {
  static const std::set<std::string> kinds{"ifcproject",
                                           "ifcunitassignment",
                                           "ifcsiunit",
                                           "ifcconversionbasedunit",
                                           "ifcconversionbasedunitwithoffset",
                                           "ifcmeasurewithunit"};
  std::map<std::string_view, Entity> entities;
  std::size_t begin = 0;
  visit_code(text, [&](std::size_t i) {
    if (text[i] != ';') return;
    const std::string_view statement = trimmed(text.substr(begin, i - begin));
    begin = i + 1;
    const std::size_t equals = statement.find('=');
    const std::size_t open = statement.find('(');
    if (!statement.starts_with('#') || equals == std::string_view::npos ||
        open == std::string_view::npos || open < equals) {
      return;
    }
    const std::string_view type = trimmed(statement.substr(equals + 1, open - equals - 1));
    constexpr std::size_t longest = 40;
    if (type.size() > longest) return;
    std::string kind = small_letters(std::string(type));
    if (kinds.count(kind) == 0) return;
    entities[trimmed(statement.substr(0, equals))] = {std::move(kind),
                                                      arguments_of(inside_parentheses(statement))};
  });
  return entities;
}

class UnitReader {
 public:
  UnitReader(std::map<std::string_view, Entity> entities, std::string place)
      : entities_(std::move(entities)), place_(std::move(place)) {}

  std::optional<IfcLengthUnit> length_unit() const {
    const Entity* assignment = assigned();
    if (assignment == nullptr || assignment->arguments.empty()) return {};
    std::optional<IfcLengthUnit> found;
    std::string_view found_name;
    for (const std::string_view name : arguments_of(inside_parentheses(assignment->arguments[0]))) {
      const Entity* unit = entity(name);
      if (unit == nullptr || !is_of_length(*unit)) continue;
      if (found && name == found_name) continue;
      if (found) {
        throw Error(place_, "assigns two units of length", "leave one in its IFCUNITASSIGNMENT");
      }
      found_name = name;
      found = IfcLengthUnit{metres_of(name), unit->type == "ifcsiunit"};
    }
    return found;
  }

 private:
  const Entity* entity(std::string_view name) const {
    const auto found = entities_.find(name);
    return found == entities_.end() ? nullptr : &found->second;
  }

  /// The project's assignment, its last argument; without a project the first there is.
  const Entity* assigned() const {
    const Entity* any = nullptr;
    for (const auto& [name, one] : entities_) {
      if (one.type == "ifcunitassignment" && any == nullptr) any = &one;
      if (one.type != "ifcproject") continue;
      const Entity* its = entity(one.arguments.back());
      if (its != nullptr && its->type == "ifcunitassignment") return its;
    }
    return any;
  }

  static bool is_of_length(const Entity& unit) {
    return unit.arguments.size() >= 2 &&
           small_letters(std::string(unit.arguments[1])) == ".lengthunit.";
  }

  double metres_of(std::string_view name, int depth = 0) const {
    constexpr int deepest = 8;  // a yard by feet by inches by metres
    const Entity* unit = entity(name);
    if (depth > deepest || unit == nullptr || !is_of_length(*unit)) fail(name);
    if (unit->type == "ifcsiunit" && unit->arguments.size() == 4 &&
        small_letters(std::string(unit->arguments[3])) == ".metre.") {
      return prefix_of(unit->arguments[2], name);
    }
    if (!unit->type.starts_with("ifcconversionbasedunit") || unit->arguments.size() < 4) fail(name);
    const Entity* measure = entity(unit->arguments[3]);
    if (measure == nullptr || measure->type != "ifcmeasurewithunit" ||
        measure->arguments.size() != 2) {
      fail(name);
    }
    std::string number(trimmed(inside_parentheses(measure->arguments[0])));
    if (number.ends_with('.')) number += '0';
    const std::optional<double> value = vernier::internal::to_real(number);
    const double metres = value.value_or(0) * metres_of(measure->arguments[1], depth + 1);
    if (!(metres >= 1e-9 && metres <= 1e9)) fail(name);
    return metres;
  }

  double prefix_of(std::string_view word, std::string_view name) const {
    static const std::map<std::string, double> prefixes{
        {"$", 1},          {".exa.", 1e18},  {".peta.", 1e15},  {".tera.", 1e12},
        {".giga.", 1e9},   {".mega.", 1e6},  {".kilo.", 1e3},   {".hecto.", 1e2},
        {".deca.", 10},    {".deci.", 0.1},  {".centi.", 1e-2}, {".milli.", 1e-3},
        {".micro.", 1e-6}, {".nano.", 1e-9}, {".pico.", 1e-12}, {".femto.", 1e-15},
        {".atto.", 1e-18}};
    const auto found = prefixes.find(small_letters(std::string(word)));
    if (found == prefixes.end()) fail(name);
    return found->second;
  }

  [[noreturn]] void fail(std::string_view name) const {
    constexpr std::size_t longest = 20;
    throw Error(
        place_,
        "has a unit of length that is not understood: " + std::string(name.substr(0, longest)),
        "export it in metres, millimetres, feet or inches");
  }

  std::map<std::string_view, Entity> entities_;
  std::string place_;
};

}  // namespace

std::optional<IfcLengthUnit> ifc_length_unit(std::string_view text, const std::string& place) {
  const std::string plain = without_comments(text);
  return UnitReader(entities_of_units(plain), place).length_unit();
}

}  // namespace vernier::sim::internal
