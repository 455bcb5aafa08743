// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/office_clutter.h"

#include <algorithm>

#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Braces fix the order of evaluation of several draws in one expression.

// Adjacent spines share an edge, as high as the taller one.
void row_of_books(Shapes& loose, double x, double end, double board, RandomStream& draws) {
  double last_height = 0;
  while (true) {
    const double width = draws.uniform(0.04, 0.12);
    const double height = draws.uniform(0.17, shelf_clear_height_m - 0.03);
    const bool fits = x + width <= end;
    const double edge = std::max(last_height, fits ? height : 0.0);
    if (edge > 0) loose.line({x, book_front_m, board}, {x, book_front_m, board + edge});
    if (!fits) return;
    loose.line({x, book_front_m, board + height}, {x + width, book_front_m, board + height});
    x += width;
    last_height = height;
    if (draws.uniform() < 0.12) {
      loose.line({x, book_front_m, board}, {x, book_front_m, board + height});
      x += draws.uniform(0.04, 0.2);
      last_height = 0;
    }
  }
}

void fill_board(BuildingSite& site, double x, double board, RandomStream& draws) {
  const double full = x + shelf_clear_m;
  const double start = x + draws.uniform(0.005, 0.15);
  const double kind = draws.uniform();
  if (kind < 0.2) return;
  if (kind < 0.45) {
    const double width = draws.uniform(0.25, 0.5), height = draws.uniform(0.15, 0.32);
    site.loose().box({start, 0.06, board}, {start + width, 0.3, board + height}, standing_faces);
    return;
  }
  row_of_books(site.loose(), start, x + draws.uniform(0.5, 1) * (full - 0.005 - x), board, draws);
}

void framed_picture(Shapes& loose, const Vector2d& low, const Vector2d& high, RandomStream& draws) {
  loose.upright_rectangle(low.x(), low.y(), high.x(), high.y(), 0.015);
  const double border = draws.uniform(0.02, 0.05);
  loose.upright_rectangle(low.x() + border, low.y() + border, high.x() - border, high.y() - border,
                          0.012);
}

// A sheet on the wall with a few ruled lines or a picture.
void poster(Shapes& loose, const Vector2d& low, const Vector2d& high, RandomStream& draws) {
  loose.upright_rectangle(low.x(), low.y(), high.x(), high.y(), 0.005);
  const Vector2d size = high - low;
  double z = high.y() - draws.uniform(0.08, 0.15) * size.y();
  const int lines = 2 + static_cast<int>(draws.below(4));
  for (int i = 0; i < lines; ++i) {
    const double x0 = low.x() + 0.1 * size.x(), x1 = high.x() - draws.uniform(0.1, 0.5) * size.x();
    loose.line({x0, 0.005, z}, {x1, 0.005, z});
    z -= draws.uniform(0.06, 0.12) * size.y();
  }
  if (z - low.y() > 0.3 * size.y()) {
    loose.upright_rectangle(low.x() + 0.1 * size.x(), low.y() + 0.08 * size.y(),
                            high.x() - 0.15 * size.x(), z, 0.005);
  }
}

}  // namespace

void fill_bookshelf(BuildingSite& site,
                    const QuarterFrame& frame,
                    double x_m,
                    RandomStream& draws) {
  site.loose().frame = frame;
  for (const double board : shelf_boards_m) {
    fill_board(site, x_m + shelf_side_m, board, draws);
  }
}

void pin_papers(BuildingSite& site,
                const QuarterFrame& frame,
                const Vector2d& low_m,
                const Vector2d& high_m,
                RandomStream& draws) {
  site.loose().frame = frame;
  double x = low_m.x() + draws.uniform(0.02, 0.1);
  while (true) {
    const bool upright = draws.below(3) > 0;
    const double scale = draws.uniform(0.7, 1.3);
    const double width = scale * (upright ? 0.21 : 0.297),
                 height = scale * (upright ? 0.297 : 0.21);
    if (x + width > high_m.x() - 0.02) return;
    const double z = draws.uniform(low_m.y() + 0.02, high_m.y() - 0.02 - height);
    site.loose().upright_rectangle(x, z, x + width, z + height, 0.018);
    if (draws.below(2)) {
      const double line = z + draws.uniform(0.6, 0.9) * height;
      site.loose().line({x + 0.02, 0.018, line}, {x + width - 0.02, 0.018, line});
    }
    x += width + draws.uniform(0.03, 0.35);
  }
}

void litter_top(BuildingSite& site,
                const QuarterFrame& frame,
                const Vector3d& corner_m,
                const Vector2d& size_m,
                int things,
                RandomStream& draws) {
  for (int i = 0; i < things; ++i) {
    const double width = draws.uniform(0.1, 0.32), depth = draws.uniform(0.1, 0.3);
    const double height = draws.uniform(0.02, 0.2);
    if (size_m.x() <= width || size_m.y() <= depth) continue;
    const Vector3d low = corner_m + Vector3d{draws.uniform(0, size_m.x() - width),
                                             draws.uniform(0, size_m.y() - depth), 0};
    const AlignedBox3d box(low, low + Vector3d(width, depth, height));
    if (!site.is_free(frame * box)) continue;
    site.occupy(frame * box);
    site.loose().frame = frame;
    site.loose().box(box.min(), box.max(), standing_faces);
  }
}

void stack_cartons(BuildingSite& site,
                   const QuarterFrame& frame,
                   const Vector3d& corner_m,
                   const Vector2d& size_m,
                   RandomStream& draws) {
  double x = corner_m.x() + draws.uniform(0.02, 0.2);
  while (true) {
    const Vector3d size{draws.uniform(0.2, 0.5), draws.uniform(0.2, size_m.y()),
                        draws.uniform(0.12, 0.4)};
    if (x + size.x() > corner_m.x() + size_m.x()) return;
    const Vector3d low(x, corner_m.y() + draws.uniform(0, size_m.y() - size.y()), corner_m.z());
    site.try_carton(frame, AlignedBox3d(low, low + size));
    x += size.x() + draws.uniform(0.05, 0.7);
  }
}

void hang_pictures(BuildingSite& site, const RoomWall& wall, int tries, RandomStream& draws) {
  for (int i = 0; i < tries; ++i) {
    const double width = draws.uniform(0.25, 0.95), height = draws.uniform(0.25, 0.75);
    const Vector2d low{draws.uniform(0.05, std::max(0.06, wall.length_m - width - 0.05)),
                       draws.uniform(1.15, 2.2 - height)};
    const Vector2d high = low + Vector2d(width, height);
    const bool framed = draws.below(2);
    const AlignedBox3d box(Vector3d(low.x(), 0, low.y()), Vector3d(high.x(), 0.05, high.y()));
    if (!site.is_free(wall.frame * box)) continue;
    site.occupy(wall.frame * box);
    site.loose().frame = wall.frame;
    if (framed) {
      framed_picture(site.loose(), low, high, draws);
    } else {
      poster(site.loose(), low, high, draws);
    }
  }
}

void drop_cartons(BuildingSite& site, const RoomWall& wall, int tries, RandomStream& draws) {
  for (int i = 0; i < tries; ++i) {
    const Vector3d size{draws.uniform(0.25, 0.6), draws.uniform(0.2, 0.45),
                        draws.uniform(0.2, 0.5)};
    const Vector3d low{draws.uniform(0.02, std::max(0.03, wall.length_m - size.x())),
                       draws.uniform(0.02, 0.12), 0};
    const AlignedBox3d box(low, low + size);
    if (!site.try_carton(wall.frame, box) || draws.below(2)) continue;
    const Vector3d upper{size.x() * draws.uniform(0.6, 0.95), size.y() * draws.uniform(0.7, 0.95),
                         size.z() * 0.8};
    const Vector3d corner(low.x() + 0.01, low.y() + 0.005, low.z() + size.z());
    site.try_carton(wall.frame, AlignedBox3d(corner, corner + upper));
  }
}

void run_cables(BuildingSite& site, const RoomWall& wall, RandomStream& draws) {
  const double ceiling = site.room().high_m.z();
  const double width = draws.uniform(0.12, 0.3), depth = draws.uniform(0.1, 0.25);
  const AlignedBox3d duct(Vector3d(0, 0, 0), Vector3d(width, depth, ceiling));
  site.loose().frame = wall.frame;
  if (draws.below(2) && site.is_free(wall.frame * duct)) {
    site.occupy(wall.frame * duct);
    site.loose().line({width, 0, 0}, {width, depth, 0});
    site.loose().line({width, depth, 0}, {width, depth, ceiling});
    site.loose().line({0, depth, 0}, {width, depth, 0});
    site.loose().line({width, 0, 0}, {width, 0, ceiling});
    site.loose().line({0, depth, 0}, {0, depth, ceiling});
    site.loose().line({0, depth, ceiling}, {width, depth, ceiling});
    site.loose().line({width, 0, ceiling}, {width, depth, ceiling});
    site.loose().surfaces_of_box(duct.min(), duct.max(), right_face | front_face);
  }
  const double x = draws.uniform(0.4, std::max(0.5, wall.length_m - 0.4));
  const double from = draws.uniform(1.1, 2.0);
  const AlignedBox3d conduit(Vector3d(x - 0.06, 0, from - 0.06), Vector3d(x + 0.06, 0.02, ceiling));
  if (site.is_free(wall.frame * conduit)) {
    site.occupy(wall.frame * conduit);
    for (const double side : {x - 0.015, x + 0.015}) {
      site.loose().line({side, 0.015, from + 0.05}, {side, 0.015, ceiling});
    }
    site.loose().upright_rectangle(x - 0.05, from - 0.05, x + 0.05, from + 0.05, 0.018);
  }
  const double start = draws.uniform(0.1, 0.4) * wall.length_m;
  const double end = draws.uniform(0.5, 0.95) * wall.length_m, z = draws.uniform(2.15, 2.3);
  const AlignedBox3d trunking(Vector3d(start, 0, z), Vector3d(end, 0.02, z + 0.06));
  if (draws.below(2) && z + 0.06 < ceiling && site.is_free(wall.frame * trunking)) {
    site.occupy(wall.frame * trunking);
    site.loose().upright_rectangle(start, z, end, z + 0.06, 0.02);
  }
}

}  // namespace vernier::sim::internal
