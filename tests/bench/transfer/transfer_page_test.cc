#include "bench/transfer/transfer_page.h"

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

using nlohmann::json;

json run(const char* method, int not_uniform) {
  return {{"exemplar", "a <fire>"},
          {"design", "plume"},
          {"size", {256, 192}},
          {"method", method},
          {"sharpness", {0.9, nullptr, 0.8}},  // nothing opaque in a frame has no sharpness
          {"structure", {0.9, nullptr, 0.8}},
          {"colours", {0.1, 0.2, 0.1}},
          {"change", {4.0, 5.0}},
          {"not_uniform", not_uniform},
          {"violations", 17},
          {"cpu_s", 0.75}};
}

TEST(TransferPage, DrawsEveryMethodAndCountsWhatWasPromised) {
  json result{{"machine", {{"processor", "a <processor>"}, {"threads", 2}, {"compiler", "g++"}}},
              {"runs", {run("uniform", 0), run("nearest", 3)}},
              {"curve", json::array()}};
  std::string page = transfer_page(result);
  std::size_t drawings = 0;
  for (std::size_t at = page.find("role=\"img\""); at != std::string::npos;
       at = page.find("role=\"img\"", at + 1))
    ++drawings;
  EXPECT_EQ(drawings, 4u);
  EXPECT_NE(page.find("<h2>a &lt;fire&gt;</h2>"), std::string::npos);
  EXPECT_NE(page.find("<td>nearest</td><td>3</td><td>3</td><td>17</td><td>0.25</td>"), std::string::npos);
  EXPECT_EQ(page.find("Cost of a frame"), std::string::npos);
  for (const char* outside : {"src=", "href=", "@import", "url(", "nan"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;

  for (const double mpix : {0.5, 1.0})
    result["curve"].push_back({{"mpix", mpix},
                               {"wall_s", 9.0},
                               {"cpu_s", 40 * mpix},
                               {"prepare_s", 1.0},
                               {"search_s", 2.0},
                               {"assign_s", 3.0},
                               {"vote_s", 4.0}});
  page = transfer_page(result);
  EXPECT_NE(page.find("<td>0.50</td><td>20.0</td><td>9.0</td>"), std::string::npos);
}

}  // namespace
}  // namespace freshet::bench
