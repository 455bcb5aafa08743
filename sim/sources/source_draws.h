// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

/// The random numbers of a source for a feature: by what it acts on, never by its place in a list.
inline vernier::internal::RandomStream draws_of(const SensingContext& context,
                                                vernier::internal::DrawSource source,
                                                std::uint32_t feature,
                                                std::uint32_t eye = 0) {
  return vernier::internal::RandomStream({.seed = context.seed,
                                          .trial = context.trial,
                                          .feature = feature,
                                          .source = static_cast<std::uint32_t>(source),
                                          .eye = eye,
                                          .frame = context.frame});
}

}  // namespace vernier::sim::internal
