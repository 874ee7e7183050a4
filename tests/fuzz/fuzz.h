// tests/fuzz/fuzz.h — what all fuzz targets share: bytes as numbers, bytes as a file, and what may be thrown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>

#include "freshet/error.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::fuzz {

using Data = std::span<const std::uint8_t>;

/// Ends the process as a fault: a promise was broken.
inline void expect(bool kept, const char* promise) {
  if (kept) return;
  std::cerr << "broken promise: " << promise << "\n";
  std::abort();
}

/// Takes a number off the front; 0 where nothing is left.
template <class T = std::uint8_t>
T take(Data& data) {
  T value{};
  std::memcpy(&value, data.data(), std::min(sizeof(T), data.size()));
  data = data.subspan(std::min(sizeof(T), data.size()));
  return value;
}

inline std::span<const std::byte> bytes_of(Data data) { return std::as_bytes(data); }
inline std::string text_of(Data data) { return {data.begin(), data.end()}; }

/// The bytes as a file, in a folder of this process's own; one at a time.
class InputFile {
 public:
  InputFile(Data data, const std::string& ending) : path_(folder() / ("input" + ending)) {
    std::ofstream out(path_, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    expect(out.good(), "the input could be written to the temporary folder");
  }
  ~InputFile() { std::filesystem::remove(path_); }
  InputFile(const InputFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  static const std::filesystem::path& folder() {
    static const ScratchFolder own;
    return own.path();
  }
  std::filesystem::path path_;
};

/// Calls; what a file may cause is caught. Whatever else is thrown ends the process.
template <class Call>
void allow_errors(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    expect(error.what()[0] != 0, "an error has words");
    expect(error.kind() != ErrorKind::kCancelled, "nobody cancelled");
  }
}

}  // namespace freshet::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
