// What a store keeps of its clips: a line for each column and map of cells.   read STORE
#include <freshet/error.h>
#include <freshet/footage.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const freshet::Store store(argv[1]);
  for (const freshet::Clip& clip : store.clips()) {
    const freshet::Footage footage(store, clip.name);
    std::cout << clip.name << ": " << footage.pixel_format() << ", " << footage.bgr(0, 1).size << '\n';
    for (const std::string& name : footage.columns())
      std::cout << "  " << name << ' ' << footage.column(name).size() << '\n';
    for (const std::string& name : footage.cell_maps())
      std::cout << "  " << name << ' ' << footage.cells(name).size << '\n';
  }
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
