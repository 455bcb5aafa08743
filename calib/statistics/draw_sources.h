// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vernier::internal {

/// The source number of RandomCounter. One list for the whole project, so that no two processes
/// share a stream. Numbers are part of every stored result: never reuse one.
enum class DrawSource : std::uint32_t {
  calibration = 1,          // psi_c, the rig used by a query or (trial 2^31 + block) a map
  lateral_shift = 2,        // psi_l
  edge_loss = 3,            // psi_e
  endpoint_noise = 4,       // psi_g
  stereo_mismatch = 5,      // psi_s
  corner_loss = 6,          // psi_cd
  corner_mismatch = 7,      // psi_cm
  query_pose = 8,           // pose of a query
  simulated_board = 10,     // poses and pixel noise of simulated calibrations
  office = 11,              // generated worlds
  monte_carlo = 12,         // propagation by sampling
  left_out_boards = 13,     // splits of frames
  simulated_pairs = 14,     // points, noise and wrong matches of simulated pairs
  noisy_copy = 16,          // corners of calibrations that are solved again, and their priors
  wishart = 17,             // null distribution of a sample covariance's eigenvalues
  vertical_field = 22,      // triples of matches
  full_search = 23,         // blocks of stretch correlation that search everywhere
  cluster_bootstrap = 25,   // clusters of bootstrap intervals
  odometry_links = 26,      // links of three corners from which motions are drawn
  corner_noise = 27,        // psi_g of corners
  corner_appearance = 28,   // descriptors of simulated corners
  corner_sighting = 29,     // noise of their descriptors, a sighting
  corner_consensus = 30,    // pairs of corners from which poses on a map are drawn
  clutter = 31,             // false edges
  mount = 32,               // height, pitch and roll of the camera
  moved_furniture = 33,     // which objects moved since the map was recorded, and whereto
  odometry = 34,            // wheels of a simulated robot, and the noise of its steps
  servo_start = 35,         // door and start of a trial of visual servoing
  surface_appearance = 36,  // reflectances, textures and painted lines of rendered worlds
  sensor_noise = 37,        // photons and read noise of rendered images
  unseen_edges = 38,        // edges that no image shows
  split_halves = 39,        // which frames make the halves of a split
  calibration_views = 40,   // which views of a board a calibration takes
  planned_views = 41,       // kinds and sequences of views that a plan expects
  injected_noise = 42,      // noise of simulated boards beside real ones
  missed_edges = 43,        // edges that a view misses whole
  curvature = 44,           // rigs that show how linear a covariance is
  // 9 is reserved, for the rig that a map was recorded with; 15, 18 to 21 and 24 are retired or
  // reserved. A new source takes the number after the largest, and a row in docs/conventions.md.
};

}  // namespace vernier::internal
