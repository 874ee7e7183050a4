// Lists the clips of a store: what a program that links Freshet begins with.

#include <iostream>

#include "freshet/error.h"
#include "query/stored/patch_table.h"
#include "store/store.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const freshet::store::Snapshot snapshot = freshet::store::Store::open_read(argv[1]).snapshot();
    for (freshet::store::ClipId id : snapshot.clips()) std::cout << snapshot.clip(id).name << '\n';
    std::cout << freshet::query::read_patch_table(snapshot).size() << " patches\n";
    return 0;
  } catch (const freshet::Error& fault) {
    std::cerr << fault.what() << '\n';
    return 1;
  }
}
