// Real clips whose cameras are known (see ingest/screening.h for the table of all fifty).

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "ingest/screening.h"
#include "media/video/video_reader.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

struct KnownCamera {
  const char* clip;
  bool taken;
};

class Footage : public testing::TestWithParam<KnownCamera> {};

TEST_P(Footage, IsTakenOrRefusedAsItsCameraDeserves) {
  const char* variable = std::getenv("FRESHET_FOOTAGE");
  const fs::path footage = variable ? fs::path(variable) : fs::path(FRESHET_SOURCE_DIR) / "../shared/footage";
  const fs::path path = footage / "clips" / GetParam().clip;
  if (!fs::exists(path))
    GTEST_SKIP() << path << " is missing: set FRESHET_FOOTAGE to the folder of real clips";
  media::VideoReader reader(path);
  const media::VideoInfo info = reader.info();
  Screener screener({info.layout.width, info.layout.height},
                    static_cast<double>(info.fps_num) / info.fps_den);
  while (const auto frame = reader.next()) screener.add(media::to_luma(*frame));
  const Verdict verdict = judge(screener.finish());
  EXPECT_EQ(verdict.refusals.empty(), GetParam().taken)
      << (verdict.refusals.empty() ? "nothing was found against it" : verdict.refusals.front());
}

INSTANTIATE_TEST_SUITE_P(
    , Footage,
    testing::Values(KnownCamera{"water/brook_mossy_rocks.mp4", true},        // fixed, static banks
                    KnownCamera{"water/sea_surface_dark.mp4", true},         // fixed, water alone
                    KnownCamera{"fire/flames_wall_black.mp4", true},         // flickers in every frame
                    KnownCamera{"clouds/clouds_summer_contrail.mp4", true},  // all of the frame drifts
                    KnownCamera{"clouds/clouds_gap_slow.mp4", true},         // slowly
                    KnownCamera{"water/river_shallow_gravel.mp4", true},     // in the hand, still enough
                    KnownCamera{"water/waterfall_gorge.mp4", false},         // pans by 8 %, then settles
                    KnownCamera{"fire/embers_closeup.mp4", false},           // pans slowly
                    KnownCamera{"smoke/house_fire_black_smoke.mp4", false}),
    [](const auto& known) { return fs::path(known.param.clip).stem().string(); });

}  // namespace
}  // namespace freshet::ingest
