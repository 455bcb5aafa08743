// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/image_names.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::localise::internal;

namespace {

using Indices = std::vector<std::optional<std::size_t>>;
constexpr auto none = std::nullopt;

Indices found(const std::vector<std::string>& names,
              const std::vector<std::filesystem::path>& images) {
  return names_of_images(names, images, "poses");
}

TEST(NamesOfImages, FoldersDoNotCountWhereFileNamesDiffer) {
  EXPECT_EQ(found({"b.png", "walk/a.png", "c"}, {"/data/x/a.png", "c.jpg", "b.tif", "d.png"}),
            (Indices{1, 2, 0, none}));
  EXPECT_EQ(found({}, {"a.png"}), Indices{none});
  EXPECT_EQ(found({"a.png"}, {}), Indices{});
}

TEST(NamesOfImages, TheEndingCountsWhereItTellsApart) {
  EXPECT_EQ(found({"a.jpg", "a.png"}, {"x/a.png"}), Indices{1});
  const std::string said = test::error_message([] { found({"a.jpg", "a.png"}, {"x/a.tif"}); });
  EXPECT_NE(said.find("poses: both \"a.jpg\" and \"a.png\" stand for "), std::string::npos) << said;
}

// As `render --poses` and COLMAP name them.
TEST(NamesOfImages, OfOneFileNameAreToldApartByFolders) {
  const std::vector<std::string> names{"000/left.png", "001/left.png", "./003/left.png"};
  EXPECT_EQ(found(names, {"set/001/left.png", "/x/set/000/left.png", "y/../set/003/left.png"}),
            (Indices{1, 0, 2}));
  EXPECT_EQ(found(names, {"set/002/left.png"}), Indices{none});
  // Not another folder's, though that is the only one of the name.
  EXPECT_EQ(found({"cam0/1.png", "cam0/2.png", "cam1/2.png"}, {"in/cam1/1.png"}), Indices{none});
  EXPECT_EQ(found({"cam0/1.png"}, {"cam0/1.png", "cam1/1.png"}), (Indices{0, none}));
}

TEST(NamesOfImages, OneNameForTwoImagesIsRefused) {
  const std::string said = test::error_message([] {
    found({"left.png"}, {"set/000/left.png", "set/001/left.png"});
  });
  EXPECT_NE(said.find("\"left.png\" stands for both \"set/000/left.png\" and \"set/001/left.png\""),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("as in \"001/left.png\""), std::string::npos) << said;
}

TEST(FilesOfImages, AreOfTheNearestFolder) {
  const auto of = [](const std::vector<std::filesystem::path>& files,
                     const std::vector<std::filesystem::path>& images) {
    return files_of_images(files, images, "--depth");
  };
  EXPECT_EQ(of({"depth/1.png", "depth/2.png"}, {"rgb/2.png", "rgb/3.png", "rgb/1.jpg"}),
            (Indices{1, none, 0}));
  EXPECT_EQ(of({"s1/depth/1.png", "s2/depth/1.png"}, {"s2/rgb/1.png", "s1/rgb/1.png"}),
            (Indices{1, 0}));
  EXPECT_EQ(of({"d1/1.png", "d2/1.png"}, {"rgb/1.jpg"}), Indices{none});  // as near
  EXPECT_NE(test::error_message([&] {
              of({"d/1.png"}, {"a/1.png", "b/1.png"});
            }).find("stands for"),
            std::string::npos);
}

TEST(DistinctNames, HaveAsManyFoldersAsTellThemApart) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(distinct_names({"x/a.png", "y/b.png"}), (Names{"a.png", "b.png"}));
  EXPECT_EQ(distinct_names({"set/000/left.png", "set/001/left.png"}),
            (Names{"000/left.png", "001/left.png"}));
  EXPECT_EQ(distinct_names({"a/x/1.png", "b/x/1.png", "1.png"}),
            (Names{"a/x/1.png", "b/x/1.png", "1.png"}));
  EXPECT_EQ(distinct_names({"a.png", "a.png"}), (Names{"a.png", "a.png"}));
  EXPECT_TRUE(distinct_names({}).empty());
  EXPECT_TRUE(need_folders({"0/a.png", "1/a.jpg"}));
  EXPECT_FALSE(need_folders({"0/a.png", "1/b.png"}));
}

}  // namespace
}  // namespace vernier
