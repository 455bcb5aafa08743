// What the three types of pairwise geometric histograms tell apart: a figure of image lines against
// the same turned, drawn in the other sense, and reflected.
#include <Eigen/Core>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <vector>

#include "localise/bhattacharyya.h"
#include "localise/pgh.h"
#include "stereo/segment.h"

using namespace vernier;
using Lines = std::vector<stereo::ImageSegment>;

/// Mean over the lines of the Bhattacharyya coefficient of each with itself in the other figure.
static double likeness(const Lines& p, const Lines& q, localise::PghType type) {
  localise::PghOptions options = localise::image_pgh_options();
  options.type = type;
  const auto a = plain_histograms(localise::image_histograms(p, options)).cast<double>().eval();
  const auto b = plain_histograms(localise::image_histograms(q, options)).cast<double>().eval();
  double sum = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    sum += localise::bhattacharyya_coefficient(a.row(i).transpose(), b.row(i).transpose());
  }
  return sum / static_cast<double>(a.rows());
}

int main() {
  const std::vector<Eigen::Vector2d> corners{
      {100, 80}, {340, 120}, {300, 260}, {150, 330}, {60, 200}};
  Lines figure, turned, reversed, reflected;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a = corners[i], b = corners[(i + 1) % corners.size()];
    const auto by_90_degrees = [](const Eigen::Vector2d& x) {
      return Eigen::Vector2d(-x.y(), x.x());
    };
    const auto in_mirror = [](const Eigen::Vector2d& x) { return Eigen::Vector2d(-x.x(), x.y()); };
    figure.push_back({a, b});
    turned.push_back({by_90_degrees(a), by_90_degrees(b)});
    reversed.push_back({b, a});
    reflected.push_back({in_mirror(a), in_mirror(b)});
  }
  std::puts("type       turned  reversed  reflected");
  for (const auto& [name, type] : {std::pair("mirror", localise::PghType::mirror),
                                   std::pair("rotation", localise::PghType::rotation),
                                   std::pair("directed", localise::PghType::directed)}) {
    std::printf("%-9s  %6.3f  %8.3f  %9.3f\n", name, likeness(figure, turned, type),
                likeness(figure, reversed, type), likeness(figure, reflected, type));
  }
}
