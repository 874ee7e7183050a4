#include "bench/quality/quality_retrieval.h"

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

// Two pieces: what moves to the right at 10 px/s, and what stands.
TEST(Retrieval, ComparesPatchesWithWhatIsTrueOfTheirPiece) {
  query::Target target;
  target.side = 4;
  target.corners = {{-1, 0}, {4, 0}};
  cv::Mat motion(4, 8, CV_32FC2, cv::Scalar(10, 0));
  motion.colRange(4, 8).setTo(cv::Scalar(0, 0));
  cv::Mat matte(4, 8, CV_8U, cv::Scalar(255));
  motion.row(0).setTo(cv::Scalar(-500, 0));  // beside the fluid
  matte.row(0).setTo(0);
  stored::PatchTable table;
  table.clip = {0, 0, 1, 1};
  table.mean_u = {0, 10, -40, 1};
  table.mean_v = {20, 0, 0, 0};
  const std::vector<std::vector<stored::Row>> rows{{0, 1, 2, 3}, {3}};
  const Retrieval found = retrieval_of(target, table, rows, {true, false}, motion, matte);
  EXPECT_DOUBLE_EQ(found.same_class, 0.25);  // half of the first's, none of the second's
  EXPECT_NEAR(found.angle_deg, (90 + 0 + 180) / 3.0, 1e-4);
  EXPECT_NEAR(found.speed, (1 + 0 + 2) / 3.0, 1e-6);
  const RetrievedCase none{.likeness = 0.3, .best = {1, NAN, NAN}, .labels = {1, NAN, NAN}};
  const RetrievedCase some{
      .likeness = 0.5, .best = found, .labels = {0, 30, 2}, .pieces = 10, .search_cpu_s = 0.02};
  const std::string table_text = retrieval_table(std::vector{none, some});
  for (const char* part :
       {"0.400 alike", "2.00 ms", "| candidates | 0.625 | 90.0 | 1.00 |", "| labels | 0.500 | 30.0 | 2.00 |"})
    EXPECT_NE(table_text.find(part), std::string::npos) << table_text;
}

}  // namespace
}  // namespace freshet::bench
