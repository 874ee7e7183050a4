#include "studio/projects.h"

#include <atomic>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>
#include <opencv2/imgcodecs.hpp>

#include "freshet/error.h"
#include "tests/tools/work_folder.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

class ProjectsTest : public ::testing::Test {
 protected:
  ProjectsTest() {
    cv::imwrite((work_ / "still.png").string(), cv::Mat(16, 16, CV_8UC3, cv::Scalar(90, 60, 30)));
    id_ = projects_.open_picture(work_ / "still.png", "still.png");
  }

  fs::path folder_of(const std::string& id) const { return folder_.projects() / id; }

  tools::WorkFolder work_;
  StudioFolder folder_{work_ / "room"};
  Jobs jobs_;
  Stores stores_{folder_, jobs_, {}, "freshet"};
  Projects projects_{folder_, jobs_, stores_};
  std::string id_;
};

TEST_F(ProjectsTest, OneThatCannotBeRemovedIsNamed) {
  constexpr fs::perms kRead = fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read |
                              fs::perms::group_exec | fs::perms::others_read | fs::perms::others_exec;
  for (const fs::path& folder : {work_.path(), work_ / "room", folder_.projects()})
    fs::permissions(folder, kRead | fs::perms::owner_write);
  fs::permissions(folder_of(id_), kRead);
  const bool root = ::geteuid() == 0;  // whom permissions do not stop
  ASSERT_EQ(root ? ::seteuid(65534) : 0, 0);
  std::string said;
  try {
    projects_.remove(id_);
  } catch (const Error& fault) {
    said = fault.what();
  }
  ASSERT_EQ(root ? ::seteuid(0) : 0, 0);
  EXPECT_TRUE(said.starts_with(folder_of(id_).string() + ": cannot be removed")) << said;
  fs::permissions(folder_of(id_), fs::perms::owner_all);
  projects_.remove(id_);
  EXPECT_FALSE(fs::exists(folder_of(id_)));
}

TEST_F(ProjectsTest, AreDuplicatedBySeveralWhileTheyAreDrawnOn) {
  constexpr int kEach = 60;
  const std::shared_ptr<Easel> easel = projects_.easel(id_);
  std::atomic<bool> done = false;
  std::thread pen([&] {
    while (!done) easel->project().write_history("[\"" + std::string(4096, 'x') + "\"]");
  });
  std::vector<std::string> made[2];
  const auto duplicate = [&](std::vector<std::string>& copies) {
    try {
      for (int i = 0; i < kEach; ++i) copies.push_back(projects_.duplicate(id_, 0));
    } catch (const Error& fault) {
      ADD_FAILURE() << fault.what();
    }
  };
  std::thread other([&] { duplicate(made[1]); });
  duplicate(made[0]);
  other.join();
  done = true;
  pen.join();
  std::set<std::string> all;
  for (const std::vector<std::string>& copies : made)
    for (const std::string& copy : copies) {
      EXPECT_TRUE(all.insert(copy).second) << copy;
      EXPECT_TRUE(fs::exists(folder_of(copy) / "picture.png") &&
                  fs::exists(folder_of(copy) / "document.json"));
      for (const fs::directory_entry& file : fs::directory_iterator(folder_of(copy)))
        EXPECT_NE(file.path().extension(), ".new") << file.path();
    }
  EXPECT_EQ(all.size(), 2u * kEach);
}

}  // namespace
}  // namespace freshet::studio
