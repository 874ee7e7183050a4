#include "studio/project.h"

#include <fstream>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<Project> make(const tools::WorkFolder& folder) {
  fs::copy_file(tools::sample().still, folder / "incoming");
  return Project::create(folder / "projects/fall", folder / "incoming", ".png");
}

TEST(Project, KeepsWhatWasDrawn) {
  const tools::WorkFolder folder;
  Document document;
  document.strokes = {{.points = {{10, 10}, {10, 90}}, .speed = 70.0f}};
  {
    const std::shared_ptr<Project> project = make(folder);
    EXPECT_EQ(project->save(document, 0), 1u);
  }
  const Project again(folder / "projects/fall");
  EXPECT_EQ(again.state().document, document);
  EXPECT_EQ(again.size(), cv::Size(tools::kWidth, tools::kHeight));
  EXPECT_NE(tools::text_of(folder / "projects/fall/strokes.svg").find("data-speed=\"70\""),
            std::string::npos);
}

TEST(Project, TakesAChangeOnlyOfWhatIsThere) {
  const tools::WorkFolder folder;
  const std::shared_ptr<Project> project = make(folder);
  Document first, second;
  first.frames = 10;
  second.frames = 20;
  EXPECT_EQ(project->save(first, 0), 1u);
  EXPECT_EQ(project->save(second, 0), std::nullopt);
  EXPECT_EQ(project->state().document, first);
  EXPECT_EQ(project->save(second, 1), 2u);
}

TEST(Project, PutsADamagedDocumentAside) {
  const tools::WorkFolder folder;
  make(folder);
  folder.file("projects/fall/document.json", "{\"frames\": -1}");
  const Project again(folder / "projects/fall");
  EXPECT_EQ(again.state().document, Document());
  EXPECT_FALSE(again.notice().empty());
  EXPECT_TRUE(fs::exists(folder / "projects/fall/document.damaged"));
}

TEST(Project, IsNotMadeOfWhatIsNoPicture) {
  const tools::WorkFolder folder;
  folder.file("text", "no picture");
  EXPECT_THROW(Project::create(folder / "projects/a", folder / "text", ".png"), Error);
  folder.file("text", "no picture");
  EXPECT_THROW(Project::create(folder / "projects/b", folder / "text", ".sh"), Error);
  EXPECT_FALSE(fs::exists(folder / "projects/a"));
  EXPECT_FALSE(fs::exists(folder / "projects/b"));
}

TEST(Project, LeavesItsFolderByNoLink) {
  const tools::WorkFolder folder;
  make(folder);
  fs::create_directory(folder / "outside");
  fs::create_directory_symlink(folder / "projects/fall", folder / "projects/link");
  EXPECT_THROW(Project(folder / "projects/link"), Error);
  const Project project(folder / "projects/fall");
  fs::create_directory_symlink(folder / "outside", folder / "projects/fall/exports");
  EXPECT_THROW(project.expect_export("a.mp4"), Error);
  fs::create_symlink(folder / "outside/document", folder / "projects/fall/document.json.new");
  Project linked(folder / "projects/fall");
  EXPECT_THROW(linked.save(Document(), 0), Error);
  EXPECT_FALSE(fs::exists(folder / "outside/document"));
}

TEST(Project, NamesLeadNowhere) {
  for (const char* name : {"", ".", "..", "../a", "a/b", ".hidden", "-o", "a b", "a\n", "a;b", "$(a)"}) {
    EXPECT_FALSE(is_plain_file_name(name)) << name;
    EXPECT_FALSE(is_project_name(name)) << name;
  }
  EXPECT_TRUE(is_plain_file_name("a_film-2.mp4"));
  EXPECT_EQ(project_name("../../A fall, 3.JPG"), "a-fall-3");
  EXPECT_EQ(project_name("<script>.png"), "script");
  EXPECT_EQ(project_name("...."), "picture");
  EXPECT_TRUE(is_project_name(project_name("\xe6\xbb\x9d.png")));
}

}  // namespace
}  // namespace freshet::studio
