// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/place.h"

namespace vernier::localise::internal {

/// Whether a view gives a line in space twice, which is no more evidence than once.
bool has_repeats(const PlaceView& view);

/// Leaves each line once, in another order.
void drop_repeats(PlaceView& view);

}  // namespace vernier::localise::internal
