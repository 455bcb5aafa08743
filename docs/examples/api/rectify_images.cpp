// Rectifies a pair of images so that corresponding points are in the same row.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "calib/rig_file.h"
#include "calib/triangulation.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

int main(int, char** argv) {
  using namespace vernier;
  Rig rig = read_rig(std::string(argv[1]) + "/rigs/nominal.rig.json").estimate.rig;
  rig.T_camera_first[1].R = rotation_from_vector({0.02, 0.03, -0.01});  // a badly mounted camera

  // Any image will do here. From a file: read_grey_levels.
  stereo::GreyLevels image{640, 480, std::vector<float>(640 * 480)};
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    image.values[i] = 128 + 100 * std::sin(0.2f * static_cast<float>(i % 640)) *
                                std::sin(0.3f * static_cast<float>(i / 640));
  }

  const stereo::RectifiedGeometry geometry = stereo::rectified_geometry(rig);
  const stereo::RectifiedImages images = stereo::rectified_images(rig, geometry, image, image);
  std::printf("focal length %.1f px, baseline %.4f m, blank: %.1f %% left, %.1f %% right\n",
              geometry.f_px, geometry.baseline_m, 100 * images.left_valid.blank_share(),
              100 * images.right_valid.blank_share());

  for (const double z_m : {1.0, 3.0, 10.0}) {
    const PixelPair raw = *pixel_pair(rig, {0.1, 0.2, z_m});
    const auto left = stereo::rectified_pixel(rig, geometry, 0, raw.first_px);
    const auto right = stereo::rectified_pixel(rig, geometry, 1, raw.other_px);
    std::printf("at %2.0f m: rows differ by %5.1f px raw, %.1e px rectified; disparity %.2f px\n",
                z_m, raw.first_px.y() - raw.other_px.y(), left->y() - right->y(),
                left->x() - right->x());
  }
}
