// Finds the corners of a chessboard in an image file; here in one that it draws itself.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "calib/board_detection.h"
#include "calib/board_target.h"

int main() {
  using namespace vernier;
  const double square_px = 41.3, left_px = 60.4, top_px = 70.8, pi = std::acos(-1.0);
  std::ofstream image("board.pgm", std::ios::binary);
  image << "P5\n640 480\n255\n";
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const double u = (x - left_px) / square_px, v = (y - top_px) / square_px;  // in squares
      const bool on_board = u >= 0 && u <= 10 && v >= 0 && v <= 7;
      const double dark = on_board ? std::tanh(10 * std::sin(pi * u) * std::sin(pi * v)) : -1;
      image.put(static_cast<char>(static_cast<unsigned char>(std::lround(130 - 100 * dark))));
    }
  }
  image.close();

  const BoardDetection found =
      detect_board("board.pgm", Chessboard{.columns = 9, .rows = 6, .square_m = 0.025});
  if (found.corners_px.empty()) {
    std::printf("no board: %s\n", found.reason.c_str());
    return 1;
  }
  double worst_px = 0;
  for (std::size_t i = 0; i < found.corners_px.size(); ++i) {
    const int column = found.ids[i] % 9, row = found.ids[i] / 9;
    const Eigen::Vector2d drawn(left_px + (column + 1) * square_px, top_px + (row + 1) * square_px);
    worst_px = std::max(worst_px, (found.corners_px[i] - drawn).norm());
  }
  std::printf("%zu corners, the worst %.3f px from where it was drawn\n", found.corners_px.size(),
              worst_px);
}
