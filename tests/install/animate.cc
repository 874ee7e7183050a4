// Animates a picture with the clips of a store.   animate STORE PICTURE MATTE VIDEO
#include <freshet/animate.h>
#include <freshet/error.h>
#include <freshet/picture.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  const freshet::Store store(argv[1]);
  const cv::Mat picture = freshet::read_picture(argv[2]).bgr;
  const cv::Mat matte = freshet::read_matte(argv[3], picture.size()).alpha;
  const freshet::Search search = freshet::search(store, picture, matte, {.class_name = "fall", .frames = 8});
  freshet::animate(freshet::label(search), argv[4]);
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
