#include "studio/drawing/recipe.h"

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

Document document() {
  Document document;
  document.store = tools::sample().store;
  document.class_name = "fall";
  document.frames = 4;
  return document;
}

RecipeFiles whole_picture() {
  RecipeFiles files;
  files.picture = "picture.png";
  files.whole = true;
  return files;
}

tools::Outcome animate(const tools::WorkFolder& folder, const std::string& toml) {
  folder.file("project.toml", toml);
  return folder.freshet({"synth", "animate", "--config", "project.toml", "-o", "out.mkv", "--overwrite"});
}

TEST(Recipe, IsReadByTheCommandLine) {
  const tools::WorkFolder folder;
  std::filesystem::copy_file(tools::sample().still, folder / "picture.png");
  const tools::Outcome outcome = animate(folder, recipe_toml(document(), whole_picture()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out.mkv"));
}

TEST(Recipe, SaysWhatATakeChanged) {
  Document taken = document();
  taken.layout = "stands";
  taken.detail_life = 0.25;
  const std::string toml = recipe_toml(taken, whole_picture());
  EXPECT_NE(toml.find("layout = \"stands\"\ndetail-life = 0.25\n"), std::string::npos) << toml;
  taken.flames = "clips";
  const std::string flames = recipe_toml(taken, whole_picture());
  EXPECT_NE(flames.find("method = \"forms\"\nflames = \"clips\"\n"), std::string::npos) << flames;
  EXPECT_EQ(flames.find("layout"), std::string::npos);  // an option of another method
  const tools::WorkFolder folder;
  std::filesystem::copy_file(tools::sample().still, folder / "picture.png");
  const tools::Outcome outcome = animate(folder, toml);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(Recipe, TakesNamesThatLookLikeItsOwnLanguage) {
  const tools::WorkFolder folder;
  std::filesystem::copy_file(tools::sample().still, folder / "picture.png");
  for (const char* name :
       {"a # b", "fall/[1].mkv", "a = b", "it's \"both\"", "a, b", "x\\n\\t", "<img src=x>"}) {
    Document odd = document();
    odd.excluded_clips = {name, "fall/2.mkv"};
    const tools::Outcome outcome = animate(folder, recipe_toml(odd, whole_picture()));
    EXPECT_EQ(outcome.exit_code, 1) << name;  // there is no such clip
    EXPECT_NE(outcome.err.find("no clip named \"" + std::string(name) + "\""), std::string::npos)
        << outcome.err;
  }
}

}  // namespace
}  // namespace freshet::studio
