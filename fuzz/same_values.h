// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

/// Whether a written value is the value that was read. Each throws Finding, naming what differs.
namespace vernier::fuzz {

/// Equal to the bit, or both NaN.
bool same(double a, double b);

/// All values equal to the bit but rotations, which are written as vectors: to 1e-12.
void require_same(const Rig& a, const Rig& b);

/// After a conversion to another tool's terms and back: relative to 1e-12 (docs/file-formats.md).
/// Names are not compared.
void require_close(const Rig& a, const Rig& b);

void require_same(const BoardObservations& a, const BoardObservations& b);
void require_same(const PairObservations& a, const PairObservations& b);

/// Covariances too, where they are positive semi-definite: to the bit, or relative to 1e-9 where
/// the file has only a part of a rotation.
void require_same(const RigEstimate& a, const RigEstimate& b);

}  // namespace vernier::fuzz
