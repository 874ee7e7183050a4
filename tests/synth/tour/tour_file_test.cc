#include "synth/tour/tour_file.h"

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet::synth::tour {
namespace {

TourPlan parsed(const std::string& text) { return parse_tour(text, "shots/tour.toml"); }

void refused(const std::string& text, const std::vector<std::string>& words) {
  try {
    parsed(text);
    ADD_FAILURE() << "taken: " << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << word << " is not in: " << error.what();
  }
}

TEST(TourFile, ThreeLinesAreATour) {
  const TourPlan plan = parsed("horizon = 170\nback = 190\nmove = \"truck\"\n");
  const Mesh mesh = mesh_of(plan, {640, 360});
  EXPECT_EQ(plan.move, Move::kTruck);
  EXPECT_TRUE(mesh.back);
  EXPECT_EQ(mesh.vanishing, cv::Point2d(320, 170));
  EXPECT_EQ(mesh.bottom, 190);
  EXPECT_NEAR(Room(mesh, "").back_depth(), 640 / 20.0, 0.01);
}

TEST(TourFile, AnEmptyFileIsOneToo) {
  const Mesh mesh = mesh_of(parsed(""), {640, 360});
  EXPECT_FALSE(mesh.back);
  EXPECT_EQ(mesh.vanishing, cv::Point2d(320, 180));
}

TEST(TourFile, SharesAreThoseOfThePicture) {
  const TourPlan plan = parsed(
      "relative = true\nrectangle = [0.25, 0.25, 0.75, 0.75]\n[[thing]]\nmatte = \"m.png\"\nfoot = 0.75\n");
  const Mesh mesh = mesh_of(plan, {640, 360});
  EXPECT_EQ(mesh.left, 160);
  EXPECT_EQ(mesh.bottom, 270);
  EXPECT_EQ(mesh.vanishing, cv::Point2d(320, 180));
  EXPECT_EQ(plan.things.at(0).matte, "shots/m.png");
  cv::Mat matte(360, 640, CV_8U, cv::Scalar(0));
  matte.rowRange(100, 200).setTo(255);
  const Room room(mesh, "");
  EXPECT_NEAR(depth_of(plan.things[0], plan, matte, room), 640 / 90.0, 0.01);
  EXPECT_NEAR(depth_of({.name = "a", .matte = "m.png"}, plan, matte, room), 640 / 20.0, 0.01);
}

TEST(TourFile, KeysGoOnFromTheOneBefore) {
  const TourPlan plan = parsed(
      "view = 60\n[[key]]\ntime = 0\n[[key]]\ntime = 2\nposition = [0.5, 0.1, 2]\n[[key]]\ntime = 3\nlook = "
      "[5, -2]\n");
  ASSERT_EQ(plan.keys.size(), 3U);
  EXPECT_EQ(plan.keys[0].place.view_deg, 60);
  EXPECT_EQ(plan.keys[2].place.position, cv::Vec3d(0.5, 0.1, 2));
  EXPECT_EQ(plan.keys[2].place.pitch_deg, -2);
}

TEST(TourFile, MistakesAreNamed) {
  refused("horizon = \n", {"shots/tour.toml:1", "not TOML"});
  refused("horizon = nan\n", {"horizon", "nan", "out of range"});
  refused("horizon = inf\n", {"horizon", "out of range"});
  refused("horizont = 1\n", {"horizont", "no such key", "horizon"});
  refused("rectangle = [1, 2, 3]\n", {"rectangle", "4 numbers", "one of 3"});
  refused("rectangle = [1, 2, 3, nan]\n", {"rectangle", "nan"});
  refused("back = 3\nrectangle = [1, 2, 3, 4]\n", {"back", "one of the two"});
  refused("view = 180\n", {"view", "out of range", "150"});
  refused("move = \"spin\"\n", {"move", "spin", "orbit"});
  refused("move = \"in\"\n[[key]]\ntime = 0\n", {"move", "keys"});
  refused("[[key]]\nposition = [0, 0, 0]\n", {"key 1", "needs time"});
  refused("[[key]]\ntime = 0\n[[key]]\ntime = 0\n", {"key 2", "0 does not come after 0"});
  refused("[[key]]\ntime = 2\n[[key]]\ntime = 1\n", {":4", "key 2.time", "1 does not come after 2"});
  refused("[[key]]\ntime = nan\n", {"key 1.time", "nan"});
  refused("[[key]]\ntime = 0\nposition = [0, nan, 0]\n", {"position", "nan"});
  refused("[[key]]\ntime = 0\nlook = [90, 0]\n", {"look", "-80 to 80"});
  refused("[[thing]]\nfoot = 3\n", {"thing 1", "needs matte"});
  refused("[[thing]]\nmatte = \"m.png\"\nfoot = 3\ndepth = 2\n", {"depth", "one of the two"});
  refused("[[thing]]\nmatte = \"m.png\"\ndepth = 0\n", {"depth", "out of range"});
}

TEST(TourFile, ItsKeysAreExplained) {
  for (const char* key :
       {"horizon", "vanishing", "rectangle", "move", "amount", "[[key]]", "position", "[[thing]]", "foot"})
    EXPECT_NE(tour_keys().find(key), std::string::npos) << key;
}

}  // namespace
}  // namespace freshet::synth::tour
