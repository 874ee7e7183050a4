#include "synth/transfer/state_file.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "freshet/error.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::transfer {
namespace {

class StateFile : public ::testing::Test {
 protected:
  StateFile() {
    state.frame = 7;
    state.picture = PixelGrid(3, 2, {{0.1f, 0.2f, 0.3f, 0.4f}});
    state.mask = Grid(3, 2, 0.5f);
    state.flow = VectorGrid(3, 2, {1, -2});
    state.sources = GridOf<std::int32_t>(3, 2, 41);
  }

  ScratchFolder folder;
  std::filesystem::path path = folder / "state";
  State state;
};

TEST_F(StateFile, ComesBackWhole) {
  write_state(path, state, {});
  const State back = read_state(path, {});
  EXPECT_EQ(back.frame, 7);
  EXPECT_EQ(back.picture(2, 1).c[2], 0.3f);
  EXPECT_EQ(back.mask.values, state.mask.values);
  EXPECT_EQ(back.flow(2, 1).y, -2);
  EXPECT_EQ(back.sources.values, state.sources.values);
}

TEST_F(StateFile, RefusesEveryFlippedByteAndEveryCut) {
  write_state(path, state, {});
  std::vector<char> bytes(std::filesystem::file_size(path));
  std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const auto refused = [&](const std::vector<char>& damaged) {
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(damaged.data(), static_cast<std::streamsize>(damaged.size()));
    try {
      read_state(path, {});
      return false;
    } catch (const Error& error) {
      return error.kind() == ErrorKind::kInput;
    }
  };
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<char> damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    ASSERT_TRUE(refused(damaged)) << i;
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{20}, bytes.size() - 1})
    EXPECT_TRUE(refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}));
  EXPECT_FALSE(refused(bytes));
}

TEST_F(StateFile, RefusesOtherOptions) {
  write_state(path, state, {});
  EXPECT_THROW(read_state(path, {.seed = 2}), Error);
  EXPECT_THROW(read_state(path, {.lambda = 0.3}), Error);
}

TEST_F(StateFile, NamesAFolderThatIsNotThere) {
  EXPECT_THROW(write_state(folder / "none" / "state", state, {}), Error);
  EXPECT_THROW(read_state(folder / "none", {}), Error);
}

}  // namespace
}  // namespace freshet::synth::transfer
