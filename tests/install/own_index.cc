// An index of one's own measured beside Freshet's: here one that looks at every patch.   own_index STORE
#include <freshet/benchmark.h>
#include <freshet/error.h>

#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  cv::Mat all;
  const freshet::OwnIndex own{
      .name = "brute force",
      .build = [&all](const cv::Mat& patches) { all = patches; },
      .search =
          [&all](const cv::Mat& questions, int k) {
            cv::Mat found(questions.rows, k, CV_32S);
            for (int i = 0; i < questions.rows; ++i) {
              std::vector<std::pair<double, int>> far;
              for (int row = 0; row < all.rows; ++row)
                far.push_back({cv::norm(questions.row(i), all.row(row), cv::NORM_L1), row});
              std::partial_sort(far.begin(), far.begin() + k, far.end());
              for (int j = 0; j < k; ++j) found.at<int>(i, j) = far[j].second;
            }
            return found;
          }};
  std::cout << freshet::benchmark(freshet::Store(argv[1]), own, {},
                                  {.pieces = 10, .label = false, .filters = false});
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
