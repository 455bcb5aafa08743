// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/page.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

std::string fill_page(const std::string& page,
                      const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string filled;
  std::size_t at = 0;
  while (at < page.size()) {
    std::size_t next = page.size();
    const std::pair<std::string, std::string>* which = nullptr;
    for (const auto& part : parts) {
      const std::size_t found = page.find(part.first, at);
      if (found < next) {
        next = found;
        which = &part;
      }
    }
    filled.append(page, at, next - at);
    if (which) filled += which->second;
    at = which ? next + which->first.size() : page.size();
  }
  return filled;
}

std::string data_script(const Json& data) {
  std::string json;
  // file names may contain invalid UTF-8; "<" is escaped so that it cannot open or close a tag
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      json += "\\u003c";
    } else {
      json += c;
    }
  }
  return "<script type=\"application/json\" id=\"data\">" + json + "</script>";
}

}  // namespace vernier::cli
