// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/program/session.h"

namespace vernier::cli {

/// Replaces the placeholders of a page's template in one pass; inserted text is not searched again.
std::string fill_page(const std::string& page,
                      const std::vector<std::pair<std::string, std::string>>& parts);

/// A script element with the id "data" that holds JSON; nothing in it opens or closes a tag.
std::string data_script(const Json& data);

}  // namespace vernier::cli
