// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// What to do about a word that is not one of the known: "did you mean 'name'?" or, if a few are
/// known and none is near it, a list of them.
std::string unknown_word_remedy(std::string_view word, const std::vector<std::string_view>& known);

/// The known word that is nearest to one that is none, if no more than half of its letters differ.
std::optional<std::string> near_word(std::string_view word,
                                     const std::vector<std::string_view>& known);

/// The known word that is meant by one that is none: behind its first letter one is missing, too
/// much or another, or two are exchanged. Nothing for a known word.
std::optional<std::string> misspelt_word(std::string_view word,
                                         const std::vector<std::string_view>& known);

/// The same for a key of a file: a known key in capitals, without its unit (such as _px) or with
/// another one counts as misspelt too.
std::optional<std::string> misspelt_key(std::string_view key,
                                        const std::vector<std::string_view>& known);

}  // namespace vernier::internal
