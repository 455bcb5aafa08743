// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/yaml_reader.h"

#include <fmt/format.h>
#include <yaml.h>

#include <algorithm>
#include <new>

#include "calib/base/shown_text.h"
#include "calib/base/utf8.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

/// One event of libyaml's parser, freed with it.
class YamlEvent {
 public:
  YamlEvent() = default;
  ~YamlEvent() { yaml_event_delete(&event); }
  YamlEvent(const YamlEvent&) = delete;
  YamlEvent& operator=(const YamlEvent&) = delete;

  std::size_t line() const { return event.start_mark.line + 1; }

  std::string text() const {
    const auto& scalar = event.data.scalar;
    return {reinterpret_cast<const char*>(scalar.value), scalar.length};
  }

  bool is_null() const {
    const std::string word = text();
    const bool empty =
        word.empty() || word == "~" || word == "null" || word == "Null" || word == "NULL";
    return empty && event.data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
  }

  yaml_event_t event{};
};

class YamlParser {
 public:
  YamlParser(const std::string& text, const std::string& place, const YamlLimits& limits)
      : place_(place), limits_(limits) {
    if (!yaml_parser_initialize(&parser_)) throw std::bad_alloc();
    yaml_parser_set_encoding(&parser_, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
  }
  ~YamlParser() { yaml_parser_delete(&parser_); }
  YamlParser(const YamlParser&) = delete;
  YamlParser& operator=(const YamlParser&) = delete;

  YamlValue document() {
    YamlValue root;
    for (bool found = false;;) {
      YamlEvent next;
      read(next);
      if (next.event.type == YAML_STREAM_END_EVENT) return root;
      if (next.event.type != YAML_DOCUMENT_START_EVENT) continue;
      YamlEvent first;
      read(first);
      if (!found) {
        root = value(first, 0);
      } else if (first.event.type != YAML_SCALAR_EVENT || !first.is_null()) {
        fail(next.line(), "a second document begins here", "give one document a file");
      }
      found = true;
    }
  }

 private:
  [[noreturn]] void fail(std::size_t line,
                         const std::string& fault,
                         const std::string& remedy) const {
    throw Error(fmt::format("{}:{}", place_, line), fault, remedy);
  }

  void read(YamlEvent& next) {
    if (yaml_parser_parse(&parser_, &next.event)) return;
    if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
    const std::string problem = parser_.problem ? parser_.problem : "it is malformed";
    fail(std::max(parser_.problem_mark.line, parser_.context_mark.line) + 1,
         "is not YAML: " + problem, "correct it");
  }

  YamlValue value(const YamlEvent& begin, std::size_t depth) {
    YamlValue made;
    made.line = begin.line();
    if (depth > limits_.depth) {
      fail(made.line, fmt::format("is nested more than {} levels deep", limits_.depth),
           "name another file");
    }
    if (++values_ > limits_.values) {
      fail(made.line, fmt::format("holds more than {} values", limits_.values), "split the file");
    }
    switch (begin.event.type) {
      case YAML_SCALAR_EVENT:
        check_length(begin);
        made.kind = begin.is_null() ? YamlValue::Kind::null : YamlValue::Kind::scalar;
        made.text = begin.text();
        break;
      case YAML_SEQUENCE_START_EVENT:
        made.kind = YamlValue::Kind::list;
        list(made, depth);
        break;
      case YAML_MAPPING_START_EVENT:
        made.kind = YamlValue::Kind::map;
        map(made, depth);
        break;
      case YAML_ALIAS_EVENT:
        fail(made.line, "aliases are not supported", "write the value itself");
      default:
        fail(made.line, "is not YAML", "correct it");
    }
    return made;
  }

  void check_length(const YamlEvent& scalar) const {
    if (scalar.event.data.scalar.length <= limits_.text_bytes) return;
    fail(scalar.line(), fmt::format("holds a text of more than {} bytes", limits_.text_bytes),
         "shorten it");
  }

  void list(YamlValue& made, std::size_t depth) {
    for (;;) {
      YamlEvent next;
      read(next);
      if (next.event.type == YAML_SEQUENCE_END_EVENT) return;
      made.items.push_back(value(next, depth + 1));
    }
  }

  void map(YamlValue& made, std::size_t depth) {
    for (;;) {
      YamlEvent key, next;
      read(key);
      if (key.event.type == YAML_MAPPING_END_EVENT) break;
      if (key.event.type != YAML_SCALAR_EVENT) {
        fail(key.line(), "a key is not a text", "correct it");
      }
      check_length(key);
      if (made.entries.size() >= limits_.keys) {
        fail(key.line(), fmt::format("holds a map of more than {} keys", limits_.keys),
             "use a list");
      }
      read(next);
      made.entries.push_back({std::string(key.text()), value(next, depth + 1)});
    }
    check_keys(made);
  }

  void check_keys(const YamlValue& map) const {
    std::vector<const YamlValue::Entry*> sorted;
    for (const auto& entry : map.entries) sorted.push_back(&entry);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto* a, const auto* b) { return a->key < b->key; });
    const auto twice =
        std::adjacent_find(sorted.begin(), sorted.end(),
                           [](const auto* a, const auto* b) { return a->key == b->key; });
    if (twice == sorted.end()) return;
    const auto& second = **std::next(twice);
    fail(second.value.line, "the key " + in_quotes(second.key) + " appears a second time",
         "keep one");
  }

  yaml_parser_t parser_{};
  const std::string& place_;
  const YamlLimits& limits_;
  std::size_t values_ = 0;
};

}  // namespace

const YamlValue* YamlValue::find(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const auto& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &found->value;
}

YamlValue parse_yaml(std::string_view text, const std::string& place, const YamlLimits& limits) {
  check_text(text, place, "a YAML file", limits.bytes);
  // libyaml compares each with all before.
  const std::size_t tag = text.starts_with("%TAG") ? 0 : text.find("\n%TAG");
  if (tag != std::string_view::npos) {
    throw Error(fmt::format("{}:{}", place, line_of(text, tag + 1)),
                "directives of tags are not supported", "remove the line");
  }
  std::string body(text);
  if (body.starts_with("%YAML:")) body[0] = '#';
  return YamlParser(body, place, limits).document();
}

}  // namespace vernier::internal
