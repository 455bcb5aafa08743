// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/external_matcher.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

namespace fs = std::filesystem;
constexpr float no_match = std::numeric_limits<float>::quiet_NaN();

/// Programs are shell scripts written here; the system's temporary folder is one of the test, with
/// blanks and a placeholder in its name, and has to be empty again after every run.
class ExternalMatcher : public testing::Test {
 protected:
  ExternalMatcher() {
    if (const char* before = std::getenv("TMPDIR")) tmpdir_before_ = before;
    temporary_ = folder_.path() / "a b {least} $(touch x) 'q";
    fs::create_directory(temporary_);
    ::setenv("TMPDIR", temporary_.c_str(), 1);
    for (int i = 0; i < 12; ++i) {
      pair_.left.values.push_back(static_cast<float>(20 * i) + 0.4f);
      pair_.right.values.push_back(static_cast<float>(255 - 20 * i) - 0.4f);
    }
    pair_.left.width_px = pair_.right.width_px = 4;
    pair_.left.height_px = pair_.right.height_px = 3;
    map_ = {4, 3, {1, 2, 3, no_match, 0.5f, 1.25f, 3, 2, 1, 0, 2, 1}};
  }
  ~ExternalMatcher() override {
    if (tmpdir_before_.empty()) {
      ::unsetenv("TMPDIR");
    } else {
      ::setenv("TMPDIR", tmpdir_before_.c_str(), 1);
    }
  }

  std::string script(const std::string& name, const std::string& lines) const {
    const fs::path file = folder_.write(name, "#!/bin/sh\n" + lines);
    fs::permissions(file, fs::perms::owner_all);
    return file.string();
  }
  DisparityMap map_of(const std::string& command, const ExternalMatcherOptions& options = {}) {
    DisparityMap map = external_map(pair_, {0, 3}, command, options);
    EXPECT_TRUE(fs::is_empty(temporary_));
    return map;
  }
  std::string error_output(const std::string& command, const ExternalMatcherOptions& options = {}) {
    const std::string message = test::error_message([&] {
      external_map(pair_, {0, 3}, command, options);
    });
    EXPECT_TRUE(fs::is_empty(temporary_));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    if (command.find_first_not_of(" \t") != std::string::npos) {
      EXPECT_EQ(message.rfind("matcher '" + command + "': ", 0), 0u) << message;
    }
    return message;
  }
  void expect_complaint(const std::string& command,
                        const std::string& part,
                        const ExternalMatcherOptions& options = {}) {
    const std::string message = error_output(command, options);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  void expect_same(const DisparityMap& map, const std::vector<float>& wanted) const {
    ASSERT_EQ(map.width_px, 4);
    ASSERT_EQ(map.height_px, 3);
    for (int i = 0; i < 12; ++i) {
      EXPECT_EQ(std::isnan(map.values[i]), std::isnan(wanted[i])) << i;
      if (!std::isnan(wanted[i])) {
        EXPECT_NEAR(map.values[i], wanted[i], 1e-6) << i;
      }
    }
  }

  test::Folder folder_;
  fs::path temporary_;
  std::string tmpdir_before_;
  RectifiedPair pair_;
  DisparityMap map_;
};

TEST_F(ExternalMatcher, GetsThePairAndTheRangeAndGivesItsMap) {
  write_disparity(folder_.path() / "map.pfm", map_);
  const std::string kept = folder_.path().string();
  const std::string program =
      script("own matcher.sh", "cp \"$2\" '" + kept + "/l.png'\ncp \"$4\" '" + kept +
                                   "/r.png'\necho \"$5 $6 $#\" >'" + kept + "/said'\ncp '" + kept +
                                   "/map.pfm' \"$7\"\n");
  const std::string command =
      "'" + program + "' --left {left} --right {right} {least} n={most} {output}";
  expect_same(map_of(command), map_.values);
  const cv::Mat left = cv::imread(kept + "/l.png", cv::IMREAD_UNCHANGED);
  const cv::Mat right = cv::imread(kept + "/r.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(left.type(), CV_8U);
  ASSERT_EQ(left.size(), cv::Size(4, 3));
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(left.at<uchar>(i / 4, i % 4), 20 * i);
    EXPECT_EQ(right.at<uchar>(i / 4, i % 4), 255 - 20 * i);
  }
  std::string said;
  std::getline(std::ifstream(kept + "/said"), said);
  EXPECT_EQ(said, "0 n=3 7");
  EXPECT_FALSE(fs::exists("x"));

  const Matcher matcher = external_matcher(command);
  EXPECT_EQ(matcher.name, "own matcher.sh");
  EXPECT_EQ(external_matcher(command, {.name = "mine"}).name, "mine");
  EdgePoint edge;
  edge.pixel_px << 1, 1;
  edge.normal << 1, 0;
  edge.x = 1, edge.y = 0;
  edge.row_x_px = 1.25f;
  const auto found = matcher.match(pair_, {edge, edge}, {0, 3});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].disparity_px, sample_at_edges(map_, {edge})[0].disparity_px);
}

TEST_F(ExternalMatcher, MayWriteOtherFormats) {
  const auto copy = [&](const std::string& placeholder, const fs::path& file) {
    return script("copy", "cp " + file.string() + " \"$1\"\n") + " " + placeholder +
           " {left} {right}";
  };
  std::vector<float> positive = map_.values;
  positive[9] = 1 / 256.f;  // 0 is not known in whole numbers
  write_disparity(folder_.path() / "m.npy", map_);
  write_disparity(folder_.path() / "m.png", {4, 3, positive});
  expect_same(map_of(copy("{output.npy}", folder_.path() / "m.npy")), map_.values);
  expect_same(map_of(copy("{output.pfm}", folder_.path() / "m.npy")), map_.values);
  expect_same(map_of(copy("{output.png}", folder_.path() / "m.png")), positive);
  for (float& d : positive) d /= 2;
  expect_same(map_of(copy("{output.png}", folder_.path() / "m.png"), {.scale = 512}), positive);
  cv::Mat small(3, 4, CV_8U, cv::Scalar(2));
  small.at<uchar>(0, 0) = 0;
  cv::imwrite((folder_.path() / "8.png").string(), small);
  std::vector<float> two(12, 2);
  two[0] = no_match;
  expect_same(map_of(copy("{output.png}", folder_.path() / "8.png")), two);
}

TEST_F(ExternalMatcher, KnowsNothingWhereTheMapIsOutsideTheRange) {
  map_.values[0] = -1, map_.values[1] = -16, map_.values[2] = 9, map_.values[4] = 3.4F,
  map_.values[5] = 3.6F;
  write_disparity(folder_.path() / "map.pfm", map_);
  map_.values[0] = map_.values[1] = map_.values[2] = map_.values[5] = no_match;
  const std::string program = script("copy", "cp " + folder_.path().string() + "/map.pfm \"$3\"\n");
  MapRange told;
  expect_same(map_of(program + " {left} {right} {output}",
                     {.told = [&](const MapRange& range) { told = range; }}),
              map_.values);
  EXPECT_EQ(told.within, 7u);
  EXPECT_EQ(told.above, 2u);
  EXPECT_NEAR(told.share_above(), 2.0 / 9, 1e-12);
  EXPECT_EQ(MapRange{}.share_above(), 0);
}

TEST_F(ExternalMatcher, CannotWriteNegativeDisparitiesToAPng) {
  const std::string command = "true {left} {right} {output.png}";
  EXPECT_EQ(test::error_message([&] {
              external_map(pair_, {-2, 3}, command);
            }),
            "matcher '" + command +
                "': a PNG cannot hold the disparities below 0 of a range from -2 px; use {output} "
                "or {output.npy}");
}

TEST_F(ExternalMatcher, IsToldApartAtBlanksOutsideOfQuotes) {
  const std::string kept = folder_.path().string();
  write_disparity(folder_.path() / "map.pfm", map_);
  const std::string program = script("copy", "for word; do echo \"[$word]\"; done >'" + kept +
                                                 "/said'\ncp '" + kept + "/map.pfm' \"$1\"\n");
  map_of(program +
         " {output}  'a  b'\"c'd\"  \\'e\\  \"\" '\\' \"\\\"\" $HOME *\t;{left}{right}> {} ");
  std::ifstream in(kept + "/said");
  std::vector<std::string> said;
  for (std::string line; std::getline(in, line);) said.push_back(line);
  ASSERT_EQ(said.size(), 10u);
  EXPECT_EQ(said[1], "[a  bc'd]");
  EXPECT_EQ(said[2], "['e ]");
  EXPECT_EQ(said[3], "[]");
  EXPECT_EQ(said[4], "[\\]");
  EXPECT_EQ(said[5], "[\"]");
  EXPECT_EQ(said[6], "[$HOME]");
  EXPECT_EQ(said[7], "[*]");
  EXPECT_EQ(said[8].substr(0, 2), "[;");
  EXPECT_EQ(said[9], "[{}]");
  map_of("sh -c 'cp \"$0\" \"$1\"' '" + kept + "/map.pfm' {output} {left} {right}");
}

TEST_F(ExternalMatcher, IsRefusedWithoutItsPlaceholders) {
  expect_complaint("prog {right} {output}", "has no {left}");
  expect_complaint("prog {left} {output}", "has no {right}");
  expect_complaint("prog {left} {right}", "has no {output}");
  expect_complaint("prog {left} {right} {output.tiff}", "unknown placeholder \"{output.tiff}\"");
  expect_complaint("prog {left} {right} --most={max} {output}",
                   "unknown placeholder \"{max}\"; use {left}, {right}, {least}, {most}, {output}");
  for (const char* own : {"${max}", "'awk {print}'", "{a-b}", "{", "{left", "{}"}) {
    external_matcher(std::string("prog {left} {right} {output} ") + own);
  }
  expect_complaint("prog {left} {right} {output} {output.png}", "two formats");
  expect_complaint("prog {left} {right} {output} 'x", "unclosed quote '");
  expect_complaint("", "the command is empty");
  expect_complaint(" \t", "the command is empty");
  EXPECT_EQ(test::error_message([] { external_matcher("a\nb\tc"); }),
            "matcher 'a b c': has no {left}; add it where the program expects the image");
  EXPECT_NE(test::error_message([] { external_matcher("prog"); }).find("has no {left}"),
            std::string::npos);
}

TEST_F(ExternalMatcher, TellsWhatWentWrongInTheProgram) {
  const std::string names = " {left} {right} {output}";
  expect_complaint("no_such_program_here" + names, "'no_such_program_here' not found");
  expect_complaint(folder_.write("text", "hello").string() + names, "cannot be run: Permission");
  expect_complaint(
      script("fails", "echo one >&2; echo 'two\ttabs' >&2; echo >&2; exit 3\n") + names,
      "exited with status 3: two tabs; try the command in a shell");
  expect_complaint(script("silent", "exit 1\n") + names, "exited with status 1: no output");
  expect_complaint(script("says", "echo to standard output; exit 1\n") + names,
                   "exited with status 1: to standard output");
  expect_complaint(script("long", "printf 'x%.0s' $(seq 5000) >&2; exit 1\n") + names,
                   "status 1: xxx");
  EXPECT_LT(error_output(folder_.path().string() + "/long" + names).size(), 1000u);
  expect_complaint(script("killed", "kill -9 $$\n") + names, "terminated by signal 9");
  expect_complaint(script("idle", "exit 0\n") + names, "exited with status 0 but wrote no file");
  expect_complaint(script("folder", "mkdir \"$3\"\n") + names,
                   "exited with status 0 but wrote no file");
  expect_complaint(script("text", "echo hello >\"$3\"\n") + names,
                   ": output.pfm: is neither PFM, PNG, PGM nor .npy; use");
  expect_complaint(script("cut", "printf 'Pf 4 3 -1\\nabc' >\"$3\"\n") + names,
                   ": output.pfm: has 3 bytes of values, fewer than the 48");
  write_disparity(folder_.path() / "other.pfm", {3, 4, std::vector<float>(12, 1)});
  expect_complaint(
      script("turned", "cp '" + folder_.path().string() + "/other.pfm' \"$3\"\n") + names,
      "wrote a map of 3x4 for images of 4x3");
}

/// The limit is far below what the program would take, and that far above what a test takes.
TEST_F(ExternalMatcher, IsStoppedWithAllThatItStartedAfterTheLimit) {
  const std::string pid_file = (folder_.path() / "pid").string();
  const std::string program = script("slow", "sleep 600 &\necho $! >'" + pid_file + "'\nwait\n") +
                              " {left} {right} {output}";
  expect_complaint(program, "exceeded the time limit of 0.3 s and was stopped",
                   {.time_limit_s = 0.3});
  int pid = 0;
  std::ifstream(pid_file) >> pid;
  ASSERT_GT(pid, 0);
  bool gone = false;  // whoever takes over orphans may leave it there, ended, for a while
  for (int i = 0; i < 1000 && !gone; ++i) {
    std::string word, state;
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    gone = !(stat >> word >> word >> state) || state == "Z";
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(gone);
  write_disparity(folder_.path() / "map.pfm", map_);
  const std::string quick =
      script("quick", "cp '" + folder_.path().string() + "/map.pfm' \"$3\"\n") +
      " {left} {right} {output}";
  expect_same(map_of(quick, {.time_limit_s = 500}), map_.values);
}

/// However much it writes in the meantime.
TEST_F(ExternalMatcher, IsStoppedThoughItWritesWithoutEnd) {
  for (const char* stream : {"", " >&2"}) {
    expect_complaint(
        script("chatty", std::string("yes") + stream + "\n") + " {left} {right} {output}",
        "exceeded the time limit of 0.5 s and was stopped", {.time_limit_s = 0.5});
  }
}

TEST_F(ExternalMatcher, RefusesUnequalImages) {
  pair_.right.width_px = 3, pair_.right.height_px = 4;
  expect_complaint("true {left} {right} {output}", "left image is 4x3 and the right one 3x4");
}

}  // namespace
}  // namespace vernier
