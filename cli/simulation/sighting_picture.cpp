// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/sighting_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <utility>

#include "calib/camera.h"
#include "calib/rig.h"
#include "cli/program/picture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::cli {
namespace {

constexpr int gap_px = 12, legend_px = 26;
constexpr double nearest_m = 0.05;  // nothing is projected from closer to the camera's plane

cv::Scalar bgr(const char* colour) {
  unsigned rgb = 0;
  std::sscanf(colour, "#%6x", &rgb);
  return {static_cast<double>(rgb & 255), static_cast<double>(rgb >> 8 & 255),
          static_cast<double>(rgb >> 16)};
}

}  // namespace

const char* SightingPicture::colour(Kind kind) {
  switch (kind) {
    case Kind::exact:
      return "#9aa5b1";
    case Kind::sensed:
      return "#0072b2";
    case Kind::told:
      return "#d55e00";
  }
  return "#000000";
}

SightingPicture::SightingPicture(const Rig& true_rig,
                                 const NoiseFreeView& seen,
                                 const StereoObservation& sighting,
                                 std::span<const SpaceSegment> told) {
  for (int eye = 0; eye < 2; ++eye) {
    Image& image = images_[eye];
    const Camera& camera = true_rig.cameras[eye];
    image.width = camera.size_px[0];
    image.height = camera.size_px[1];
    for (const VisibleEdge& edge : seen.edges) {
      SensedEdge exact;
      exact.truth = edge;
      image.lines.push_back({image_of(true_rig, exact, eye), Kind::exact});
    }
    for (const SpaceSegment& line : told) {
      const Eigen::Vector3d a = true_rig.T_camera_first[eye] * line.a_m;
      const Eigen::Vector3d b = true_rig.T_camera_first[eye] * line.b_m;
      if (!line.reliable || a.z() < nearest_m || b.z() < nearest_m) continue;
      image.lines.push_back({{project(camera, a), project(camera, b)}, Kind::told});
    }
    for (const StereoSegment& s : sighting.segments) {
      image.lines.push_back({eye == 0 ? s.left : s.right, Kind::sensed});
    }
    for (const SensedCorner& corner : sighting.corners) {
      image.dots.push_back({corner.pixel_px[eye], corner.mismatched});
    }
  }
}

std::string SightingPicture::image_svg(const Image& image, int number, double left_px) const {
  std::string svg = fmt::format(
      "<g transform=\"translate({0:.0f} 0)\"><clipPath id=\"image{1}\"><rect width=\"{2}\" "
      "height=\"{3}\"/></clipPath><rect width=\"{2}\" height=\"{3}\" fill=\"#fff\" "
      "stroke=\"#667\"/>\n<g clip-path=\"url(#image{1})\" fill=\"none\" "
      "stroke-linecap=\"round\">\n",
      left_px, number, image.width, image.height);
  const auto out = std::back_inserter(svg);
  for (const auto& [segment, kind] : image.lines) {
    const Eigen::Vector2d &a = segment.a_px, &b = segment.b_px;
    // Pixel centres are at whole numbers, those of SVG at halves.
    fmt::format_to(out,
                   "<path stroke=\"{}\" stroke-width=\"{}\" d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\"/>\n",
                   colour(kind), kind == Kind::exact ? 2.4 : 1, a.x() + 0.5, a.y() + 0.5,
                   b.x() + 0.5, b.y() + 0.5);
  }
  for (const auto& [at, mismatched] : image.dots) {
    fmt::format_to(out, "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"1.6\" fill=\"{}\"/>\n",
                   at.x() + 0.5, at.y() + 0.5, mismatched ? "#cc0000" : "#009e73");
  }
  return svg + "</g></g>\n";
}

std::string SightingPicture::svg() const {
  const double width = images_[0].width + gap_px + images_[1].width;
  const double height = std::max(images_[0].height, images_[1].height) + legend_px;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-1 -1 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"14\">\n<rect x=\"-1\" y=\"-1\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" fill=\"#fff\"/>\n",
      width + 2, height + 2);
  svg += image_svg(images_[0], 0, 0) + image_svg(images_[1], 1, images_[0].width + gap_px);
  double x = 4;
  const auto word = [&](const char* of, const std::string& text, double length) {
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" fill=\"{}\">{}</text>\n", x, height - 8, of,
                       text);
    x += length;
  };
  word("#667788", "as they are", 100);
  word(colour(Kind::sensed), "as they are sensed", 150);
  word(colour(Kind::told), "as the estimator places them", 220);
  word("#009e73", "corners", 70);
  word("#cc0000", "with a wrong partner", 150);
  return svg + "</svg>\n";
}

std::string SightingPicture::png() const {
  constexpr int scale = 2, shift = 4;
  const int width = images_[0].width + gap_px + images_[1].width;
  const int height = std::max(images_[0].height, images_[1].height);
  cv::Mat picture(height * scale, width * scale, CV_8UC3, cv::Scalar(255, 255, 255));
  int left = 0;
  for (const Image& image : images_) {
    cv::Mat part = picture(cv::Rect(left * scale, 0, image.width * scale, image.height * scale));
    const auto point = [&](const Eigen::Vector2d& at) {
      constexpr double far_px = 20'000;  // beyond it is cut off all the same
      const auto fixed = [&](double x) {
        return cvRound(std::clamp(x + 0.5, -far_px, far_px) * scale * (1 << shift));
      };
      return cv::Point(fixed(at.x()), fixed(at.y()));
    };
    for (const auto& [segment, kind] : image.lines) {
      cv::line(part, point(segment.a_px), point(segment.b_px), bgr(colour(kind)),
               kind == Kind::exact ? 4 : 2, cv::LINE_AA, shift);
    }
    for (const auto& [at, mismatched] : image.dots) {
      cv::circle(part, point(at), 3 << shift, bgr(mismatched ? "#cc0000" : "#009e73"), cv::FILLED,
                 cv::LINE_AA, shift);
    }
    cv::rectangle(part, {0, 0, part.cols, part.rows}, bgr("#666677"));
    left += image.width + gap_px;
  }
  return png_of(picture);
}

}  // namespace vernier::cli
