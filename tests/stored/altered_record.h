// tests/stored/altered_record.h — a store's first clip with a record that lies, and hashes that are right.
#pragma once

#include <filesystem>
#include <functional>

#include "store/environment.h"
#include "store/records/clip_record.h"

namespace freshet::stored {

/// No store of the file may be open.
inline void alter_first_clip(const std::filesystem::path& file,
                             const std::function<void(store::StoredClip&)>& change) {
  store::WriteTransaction txn(store::Environment::open(file, store::Access::kWrite));
  const store::Bytes key = store::clip_key(store::ClipId{0});
  const store::Bytes before = txn.get(store::Table::kClips, key).value();
  const store::RecordPlace place = txn.place(store::Table::kClips, key);
  store::StoredClip clip =
      store::parse_clip(store::decode_record(place, before, store::kMaxClipRecordBytes)).value();
  change(clip);
  const store::Bytes bytes = store::serialise_clip(clip),
                     after = store::encode_record(place, bytes, 1, bytes.size());
  store::StoreAccount account = store::read_account(txn);
  account.clips.subtract(before);
  account.clips.add(after);
  txn.put(store::Table::kClips, key, after);
  store::put_account(txn, account);
  txn.commit();
}

}  // namespace freshet::stored
