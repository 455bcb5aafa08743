// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/view_file.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "tests/support/camera_views.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::localise;

namespace {

using test::error_message;
using test::Folder;

const std::string line = R"({"a_m":[2,1,0],"b_m":[2,1,1.5],"kind":"vertical","sigma_m":0.02})";

TEST(ViewFile, GivesBackWhatWasWritten) {
  const Folder folder;
  std::vector<RecordedLooks> views;
  for (int i = 0; i < 3; ++i) {
    PlaceView view = test::view_of(test::random_room(i, 10), 0.1);
    view.image_lines.push_back({{1.5, 2}, {300, 4.25 + i}});
    if (i > 0) view.monocular_lines.push_back({{1.5, 200}, {301 + i, 200.5}});
    RecordedLooks recorded{{{view, 0}}, Pose2D{0.1 * i, -2, 0.3}};
    if (i == 1) recorded.looks.push_back({view, -1.25});
    if (i == 2) recorded.pose.reset();
    views.push_back(recorded);
  }
  write_views(folder.path() / "views.jsonl", views);
  const std::vector<RecordedLooks> read = read_views(folder.path() / "views.jsonl");
  ASSERT_EQ(read.size(), views.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(read[i].looks.size(), views[i].looks.size());
    ASSERT_EQ(read[i].pose.has_value(), i != 2);
    if (i != 2) {
      EXPECT_EQ(read[i].pose->x_m, views[i].pose->x_m);
    }
    for (std::size_t k = 0; k < read[i].looks.size(); ++k) {
      const Look &a = read[i].looks[k], &b = views[i].looks[k];
      EXPECT_EQ(a.turn_rad, b.turn_rad);
      EXPECT_EQ(a.view.mount.pitch_rad, b.view.mount.pitch_rad);
      EXPECT_LT((parameters(*a.view.rig) - parameters(*b.view.rig)).cwiseAbs().maxCoeff(), 1e-12);
      ASSERT_EQ(a.view.lines.size(), b.view.lines.size());
      for (std::size_t n = 0; n < a.view.lines.size(); ++n) {
        EXPECT_LT((a.view.lines[n].a_m - b.view.lines[n].a_m).norm(), 1e-12);
        EXPECT_EQ(a.view.lines[n].kind, b.view.lines[n].kind);
        EXPECT_EQ(a.view.lines[n].sigma_m, b.view.lines[n].sigma_m);
      }
      ASSERT_EQ(a.view.image_lines.size(), 1u);
      EXPECT_EQ(a.view.image_lines[0].b_px, b.view.image_lines[0].b_px);
      ASSERT_EQ(a.view.monocular_lines.size(), i > 0 ? 1u : 0u);
      if (i > 0) {
        EXPECT_EQ(a.view.monocular_lines[0].b_px, b.view.monocular_lines[0].b_px);
      }
    }
  }
}

/// A matched pair of image lines is triangulated with the rig that the reader is given.
TEST(ViewFile, ReadsMatchedSegments) {
  const auto rig = std::make_shared<const Rig>(*test::shipped_rig());
  const auto pixels = [&](int eye, const Eigen::Vector3d& point) {
    return vernier::project(rig->cameras[eye], rig->T_camera_first[eye] * point);
  };
  const Eigen::Vector3d low(0.4, 0.5, 3), high(0.4, -0.8, 3);  // camera frame: an upright line
  std::string text = R"({"pose":[1,2,0.5],"segments":[{)";
  for (int eye = 0; eye < 2; ++eye) {
    const Eigen::Vector2d a = pixels(eye, low), b = pixels(eye, high);
    text += std::string(eye == 0 ? "\"left_px\":[" : "],\"right_px\":[") + std::to_string(a.x()) +
            "," + std::to_string(a.y()) + "," + std::to_string(b.x()) + "," + std::to_string(b.y());
  }
  const Folder folder;
  const auto file = folder.write("s.jsonl", text + "]}]}\n");
  const std::vector<RecordedLooks> read = read_views(file, rig);
  ASSERT_EQ(read.size(), 1u);
  const PlaceView& view = read[0].looks[0].view;
  ASSERT_EQ(view.lines.size(), 1u);
  EXPECT_EQ(view.lines[0].kind, LineKind::vertical);
  EXPECT_NEAR(view.lines[0].a_m.x(), 3, 1e-3);
  EXPECT_NEAR(view.lines[0].a_m.y(), -0.4, 1e-3);
  EXPECT_EQ(view.image_lines.size(), 1u);
  EXPECT_NE(error_message([&] { read_views(file); }).find("give a rig"), std::string::npos);
}

TEST(ViewFile, GivesBackCorners) {
  const Folder folder;
  PlaceView view = test::view_of({}, 0.1);
  for (int i = 0; i < 5; ++i) {
    StereoCorner corner;
    corner.left_px = {100 + i / 3.0, 20};
    corner.right_px = {90, 20.1};
    corner.covariance_px2 = (0.1 + i / 7.0) * Eigen::Matrix4d::Identity();
    corner.descriptor = Eigen::VectorXf::LinSpaced(6, -1 / 3.0f, 0.7f);
    view.corners.push_back(corner);
  }
  const auto file = folder.path() / "corners.jsonl";
  for (const bool described : {true, false}) {
    if (!described) {
      for (StereoCorner& corner : view.corners) corner.descriptor.resize(0);
    }
    write_views(file, std::vector<RecordedLooks>{{{{view, 0}}, {}}});
    const std::vector<RecordedLooks> read = read_views(file);
    const std::vector<StereoCorner>& corners = read.at(0).looks.at(0).view.corners;
    ASSERT_EQ(corners.size(), view.corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_EQ(corners[i].left_px, view.corners[i].left_px);
      EXPECT_EQ(corners[i].right_px, view.corners[i].right_px);
      EXPECT_EQ(corners[i].covariance_px2, view.corners[i].covariance_px2);
      EXPECT_EQ(corners[i].descriptor, view.corners[i].descriptor);
    }
  }
  // Alone, and without a covariance of its own.
  const auto alone =
      folder.write("alone.jsonl", R"({"corners":[{"left_px":[100,20],"right_px":[90,20]}]})");
  const auto read = read_views(alone, test::shipped_rig());
  EXPECT_EQ(read[0].looks[0].view.corners[0].covariance_px2, StereoCorner().covariance_px2);
}

TEST(ViewFile, NamesWhatIsWrongWithCorners) {
  const Folder folder;
  const std::string head = R"({"corners":[{"left_px":[100,20],"right_px":[90,20])";
  for (const auto& [text, fault] : std::vector<std::pair<std::string, std::string>>{
           {R"({"corners":[{"left_px":[100],"right_px":[90,20]}]})", "2 numbers"},
           {R"({"corners":[{"left_px":[100,20],"right_px":[90,20000]}]})", "far off the image"},
           {R"({"corners":[{"left_px":[100,20]}]})", "right_px"},
           {R"({"corners":[{"left_px":[100,null],"right_px":[90,20]}]})", "left_px"},
           {head + R"(,"covariance_px2":[[1,0],[0,1]]}]})", "4 x 4"},
           {head + R"(,"covariance":[[1]]}]})", "did you mean \"covariance_px2\"?"},
           {head + R"(,"Descriptor":[1]}]})", "did you mean \"descriptor\"?"},
           {head + R"(,"covariance_px2":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,-1]]}]})",
            "positive definite"},
           {head + R"(,"descriptor":[]}]})", "0 entries"},
           {head + R"(,"descriptor":[1e300]}]})", "beyond all limits"},
           {head + R"(,"descriptor":[1,0]},{"left_px":[1,2],"right_px":[0,2]}]})", "only some"},
           {head + R"(,"descriptor":[1,0]},{"left_px":[1,2],"right_px":[0,2],"descriptor":[1]}]})",
            "has 1 entries, that of the first corner 2"}}) {
    const auto file = folder.write("wrong.jsonl", text);
    const std::string said = error_message([&] { read_views(file, test::shipped_rig()); });
    EXPECT_NE(said.find(fault), std::string::npos) << text << ": " << said;
  }
  const auto file = folder.write("no_rig.jsonl", head + "}]}");
  EXPECT_NE(error_message([&] { read_views(file); }).find("corners need the cameras"),
            std::string::npos);
}

struct Fault {
  std::string text, place, fault;
};

TEST(ViewFile, NamesWhatIsWrong) {
  const Folder folder;
  const std::vector<Fault> faults{
      {"", "", "holds no views"},
      {"\n{\"lines\":[", ":2", ""},
      {"[]\n", ":1", "lines"},
      {"{}\n", ":1", "neither"},
      {R"({"lines":[{"a_m":[1,2],"b_m":[1,2,3],"kind":"level","sigma_m":0}]})", "a_m", "3 numbers"},
      {R"({"lines":[{"a_m":[1,2,0],"b_m":[1,2,0],"kind":"level","sigma_m":0}]})", "lines[0]",
       "same point"},
      {R"({"lines":[{"a_m":[2300,900,0],"b_m":[2300,900,1500],"kind":"level","sigma_m":20}]})",
       "a_m", "metres"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[2,1,1],"kind":"upright","sigma_m":0}]})", "kind",
       "use vertical"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[3,1,0],"kind":"vertical","sigma_m":0}]})", "kind",
       "equally high"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[2,1,1],"kind":"vertical","sigma_m":-1}]})", "sigma_m",
       "not from 0 to 1e+06"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[2,1,1],"kind":"vertical","sigma_m":1e300}]})", "sigma_m",
       "not from 0 to 1e+06"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[2,1,1e400],"kind":"vertical","sigma_m":0}]})", ":1", ""},
      {R"({"pose":[1,2,90],"lines":[)" + line + "]}", "pose[2]", "radians"},
      {R"({"pose":[1,2],"lines":[)" + line + "]}", "pose", "3 numbers"},
      {R"({"mount":{"height_m":1200,"pitch_rad":0},"lines":[]})", "height_m", "metres"},
      {R"({"mount":{"height_m":1.2,"pitch_rad":45},"lines":[]})", "pitch_rad", "radians"},
      {R"({"lines":[],"image_lines_px":[[0.1,0.2,0.3,0.4]]})", ":1", "normalised"},
      {R"({"lines":[],"image_lines_px":[[5,6,5,6]]})", "image_lines_px[0]", "same pixel"},
      {R"({"lines":[],"image_lines_px":[[5,6,5]]})", "image_lines_px[0]", "4 numbers"},
      {R"({"looks":[]})", "looks", "at least one"},
      {R"({"mount":{"height_m":1,"pitch_rad":0},"looks":[{"lines":[]}]})", ":1",
       "has \"mount\" beside \"looks\"; put it into each"},
      {R"({"segments":[],"looks":[{"lines":[]}]})", ":1", "\"segments\" beside"},
      {R"({"mout":{"height_m":1,"pitch_rad":0},"lines":[]})", ":1", "did you mean \"mount\"?"},
      {R"({"looks":[{"turn_rad":0,"camera":[],"lines":[]}]})", "looks[0]", "\"cameras\"?"},
      {R"({"lnies":[],"corners":[]})", ":1", "\"lines\"?"},
      {R"({"Pose":[1,2,0],"lines":[]})", ":1", "\"pose\"?"},
      {R"({"Mount":{"height_m":1,"pitch_rad":0},"lines":[]})", ":1", "\"mount\"?"},
      {R"({"Imge_lines_px":[],"lines":[]})", ":1", "\"image_lines_px\"?"},
      {R"({"image_lines":[],"lines":[]})", ":1", "\"image_lines_px\"?"},
      {R"({"monocular_lines":[],"lines":[]})", ":1", "\"monocular_lines_px\"?"},
      {R"({"looks":[{"lines":[]},{"turn_deg":30,"lines":[]}]})", "looks[1]", "\"turn_rad\"?"},
      {R"({"mount":{"height_m":1,"pitch_deg":9},"lines":[]})", "mount", "\"pitch_rad\"?"},
      {R"({"mount":{"heigt_m":1,"pitch_rad":0},"lines":[]})", "mount", "\"height_m\"?"},
      {R"({"lines":[{"a_m":[2,1,0],"b_m":[2,1,1],"kind":"vertical","Sigma_m":0}]})", "lines[0]",
       "\"sigma_m\"?"},
      {R"({"lines":[{"a":[2,1,0],"b_m":[2,1,1],"kind":"vertical","sigma_m":0}]})", "lines[0]",
       "\"a_m\"?"},
      {R"({"looks":[{"pose":[1,2,0],"lines":[]}]})", "looks[0].pose", "inside a look"},
      {R"({"turn_rad":1,"lines":[]})", "turn_rad", "of no look"},
      {R"({"looks":[{"turn_rad":1,"lines":[]}]})", "turn_rad", "not 0"},
      {R"({"looks":[{"lines":[]},{"lines":[]}]})", "looks[1]", "no \"turn_rad\""},
      {R"({"lines":[],"segments":[]})", ":1", "segments and lines"},
      {R"({"lines":[],"lines":[]})", ":1", ""},
  };
  for (const Fault& fault : faults) {
    const auto file = folder.write("f.jsonl", fault.text);
    const std::string message = error_message([&] { read_views(file); });
    EXPECT_EQ(message.find(file.string()), 0u) << message;
    EXPECT_NE(message.find(fault.place), std::string::npos) << message;
    EXPECT_NE(message.find(fault.fault), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// Keys of other programs are passed over.
TEST(ViewFile, MayHaveKeysOfItsOwn) {
  const Folder folder;
  for (const char* key :
       {"image", "time_s", "count", "amount", "comment", "position_m", "Image", "pose_of_robot"}) {
    const auto file = folder.write("f.jsonl", "{\"" + std::string(key) + "\":1,\"lines\":[]}");
    EXPECT_EQ(error_message([&] { read_views(file); }), "") << key;
  }
  // Also such as are nearly one that is there.
  const auto file = folder.write(
      "f.jsonl",
      R"({"mount":{"height_m":1,"pitch_rad":0,"pitch_deg":0},"pose":[1,2,0],"pose_deg":[1,2,0],)"
      R"("lines":[{"a_m":[2,1,0],"a_px":[1,2],"b_m":[2,1,1],"kind":"vertical","sigma_m":0.01,)"
      R"("sigma_px":1}]})");
  EXPECT_EQ(error_message([&] { read_views(file); }), "");
}

TEST(ViewFile, KnowsAViewWithoutLines) {
  const Folder folder;
  const auto read =
      read_views(folder.write("f.jsonl", "{\"lines\":[]}\n\n{\"lines\":[" + line + "]}"));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[0].looks[0].view.lines.empty());
  EXPECT_FALSE(read[0].looks[0].view.rig);
  EXPECT_EQ(read[1].looks[0].view.lines.size(), 1u);
}

}  // namespace
}  // namespace vernier
