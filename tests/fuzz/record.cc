// What records hold, below their hashes: clips, accounts, identities, and records sealed over any bytes.

#include <filesystem>
#include <vector>

#include "store/records/account.h"
#include "store/records/clip_record.h"
#include "store/records/identity.h"
#include "store/records/record.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

namespace {

void read_clip(std::span<const std::byte> bytes) {
  const auto clip = store::parse_clip(bytes);
  if (!clip) return;
  const store::Bytes once = store::serialise_clip(*clip);
  const auto again = store::parse_clip(once);
  fuzz::expect(again.has_value(), "a clip that was read can be written and read");
  fuzz::expect(store::serialise_clip(*again) == once, "a clip is written the same again");
}

void read_account(std::span<const std::byte> bytes) {
  const auto account = store::parse_account(bytes);
  if (!account) return;
  const store::Bytes once = store::serialise_account(*account);
  const auto again = store::parse_account(once);
  fuzz::expect(again && store::serialise_account(*again) == once, "an account is written the same again");
}

void read_record(fuzz::Data data) {
  const std::filesystem::path file = "fuzzed";
  const auto key = fuzz::bytes_of(data.first(std::min<std::size_t>(data.size(), 4)));
  const store::RecordPlace place{file, 1, store::Table::kColumns, key};
  fuzz::allow_errors([&] { store::open_record(place, fuzz::bytes_of(data)); });

  store::RecordHeader header;
  header.codec = static_cast<store::Codec>(fuzz::take(data) % 4);
  header.parameter = fuzz::take<std::uint32_t>(data);
  header.raw_bytes = fuzz::take<std::uint64_t>(data);
  header.total_bytes = fuzz::take<std::uint64_t>(data);
  header.stored_bytes = fuzz::take<std::uint64_t>(data);
  std::vector<std::byte> value(store::kRecordHeaderBytes + data.size());
  std::copy(data.begin(), data.end(),
            reinterpret_cast<std::uint8_t*>(value.data()) + store::kRecordHeaderBytes);
  store::seal_record(place, header, data.size(), value);
  fuzz::allow_errors([&] { store::decode_record(place, value, 1 << 20); });

  const store::Bytes whole = store::encode_record(place, fuzz::bytes_of(data), 1, data.size());
  const store::Bytes raw = store::decode_record(place, whole, 1 << 20);
  fuzz::expect(std::equal(raw.begin(), raw.end(), fuzz::bytes_of(data).begin(), fuzz::bytes_of(data).end()),
               "a record comes back as it was");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  switch (fuzz::take(data) % 4) {
    case 0:
      read_clip(fuzz::bytes_of(data));
      break;
    case 1:
      read_account(fuzz::bytes_of(data));
      break;
    case 2:
      store::parse_identity(fuzz::bytes_of(data));
      break;
    default:
      read_record(data);
  }
  return 0;
}
