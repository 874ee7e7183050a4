// A fuzz target without the fuzzer: runs every file of the folders and files that are named, once each.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.h"

int main(int count, char** arguments) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (const fs::path named : std::span(arguments, static_cast<std::size_t>(count)).subspan(1))
    if (fs::is_directory(named))
      for (const fs::directory_entry& entry : fs::directory_iterator(named)) files.push_back(entry.path());
    else
      files.push_back(named);
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::cerr << file.string() << "\n";  // the last one named is the one at fault
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::cout << files.size() << " inputs\n";
  return files.empty() ? 1 : 0;
}
