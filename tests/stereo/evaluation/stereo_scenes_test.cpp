// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/stereo_scenes.h"

#include <gtest/gtest.h>

#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::stereo::internal;

namespace {

class StereoSceneList : public testing::Test {
 protected:
  StereoSceneList() {
    std::filesystem::create_directory(folder_.path() / "a");
    for (const char* name :
         {"a/left.png", "a/right.png", "a/truth.png", "other.png", "a.rig.json"}) {
      folder_.write(name, "there");
    }
  }
  std::vector<StereoSceneFile> read(const std::string& text) const {
    return read_stereo_scenes(folder_.write("pairs.toml", text));
  }
  /// A pair with one line changed, and the complaint about it.
  std::string error_output(const std::string& from, const std::string& to) const {
    std::string text = pair;
    const std::size_t at = text.find(from);
    text.replace(at, from.size(), to);
    return test::error_message([&] { read(text); });
  }

  const std::string pair =
      "# a list\n[[pair]]\nname = 'one'\nleft = 'a/left.png'\nright = 'a/right.png'\n"
      "truth = 'a/truth.png'\nmax_disparity = 64\n";
  test::Folder folder_;
};

TEST_F(StereoSceneList, NamesFilesFromItsFolder) {
  const std::string absolute = (folder_.path() / "other.png").string();
  const auto scenes =
      read(pair + "[[pair]]\nname = 'two'\nleft = 'a/left.png'\nright = '" + absolute +
           "'\ntruth = 'a/truth.png'\nright_truth = 'other.png'\n"
           "truth_scale = 2.5\ntruth_kind = 'labelled'\nmin_disparity = -3\n"
           "max_disparity = 7\nrig = 'a.rig.json'\n");
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[0].name, "one");
  EXPECT_EQ(scenes[0].left, folder_.path() / "a/left.png");
  EXPECT_EQ(scenes[0].right, folder_.path() / "a/right.png");
  EXPECT_EQ(scenes[0].truth, folder_.path() / "a/truth.png");
  EXPECT_TRUE(scenes[0].right_truth.empty() && scenes[0].rig.empty());
  EXPECT_EQ(scenes[0].truth_scale, 1);
  EXPECT_EQ(scenes[0].truth_kind, TruthKind::measured);
  EXPECT_EQ(scenes[0].range.min_px, 0);
  EXPECT_EQ(scenes[0].range.max_px, 64);
  EXPECT_EQ(scenes[1].right, absolute);
  EXPECT_EQ(scenes[1].right_truth, folder_.path() / "other.png");
  EXPECT_EQ(scenes[1].truth_scale, 2.5);
  EXPECT_EQ(name(scenes[1].truth_kind), "labelled");
  EXPECT_EQ(scenes[1].range.min_px, -3);
  EXPECT_EQ(scenes[1].range.max_px, 7);
  EXPECT_EQ(scenes[1].rig, folder_.path() / "a.rig.json");
}

TEST_F(StereoSceneList, IsRefusedWithTheLineOfTheFault) {
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    const std::string message = error_output(from, to);
    EXPECT_NE(message.find("pairs.toml:" + part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  expect("name = 'one'", "nome = 'one'", "3: unknown key 'nome' in [[pair]]; did you mean 'name'?");
  expect("name = 'one'\n", "", "2: [[pair]] has no 'name'");
  expect("name = 'one'", "name = ''", "3: name is empty");
  expect("a/left.png", "a/lost.png", "4: left: no such file");
  expect("'a/right.png'", "7", "5: right is not a string");
  expect("a/truth.png", "a", "6: truth: no such file");
  expect("truth = 'a/truth.png'\n", "", "2: pair 'one' has no 'truth'");
  expect("max_disparity = 64", "max_disparity = 6.5", "7: max_disparity is not a whole number");
  expect("max_disparity = 64", "max_disparity = 99999999", "7: max_disparity is out of range");
  expect("= 64\n", "= 64\nmin_disparity = 65\n", "7: max_disparity is below min_disparity");
  expect("= 64\n", "= 64\ntruth_scale = 0\n", "8: truth_scale is not positive");
  expect("= 64\n", "= 64\ntruth_scale = nan\n", "8: truth_scale");
  expect("= 64\n", "= 64\ntruth_kind = 'good'\n", "8: unknown truth_kind 'good'");
  expect("= 64\n", "= 64\nrig = 'b.rig.json'\n", "8: rig: no such file");
  expect("= 64\n", "= 64\n" + pair, "10: duplicate name 'one'");
  expect("[[pair]]", "[pair]", "2: 'pair' is not a list of tables");
  expect("[[pair]]", "[[pairs]]", "2: unknown key 'pairs'");
  expect("= 64\n", "= \n", "7: not TOML");
  EXPECT_NE(test::error_message([&] { read("# nothing\n"); }).find("lists no pair"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] {
              read_stereo_scenes(folder_.path() / "none.toml");
            }).find("cannot be read"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
