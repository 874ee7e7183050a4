// Animates a picture, as deep as it is, with the clips of a store; what is white in HELD stands.
//   animate STORE PICTURE MATTE VIDEO [HELD]
#include <freshet/animate.h>
#include <freshet/error.h>
#include <freshet/picture.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 5 && argc != 6) return 2;
  const freshet::Store store(argv[1]);
  const freshet::Picture picture = freshet::read_picture(argv[2]);
  const cv::Size size = picture.bgr.size();
  const cv::Mat matte = freshet::read_matte(argv[3], size).alpha;
  const cv::Mat held = argc == 6 ? freshet::read_matte(argv[5], size).alpha : cv::Mat();
  const freshet::Search search =
      freshet::search(store, picture.bgr, matte, {.class_name = "fall", .frames = 8, .held = held});
  freshet::animate(freshet::label(search), argv[4], {.deep = picture.deep});
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
