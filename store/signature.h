// store/signature.h — that a store is the one that its maker signed.
#pragma once

#include <filesystem>
#include <string>

namespace freshet::store {

/// That STORE.minisig, beside the store, is a signature of its bytes by this key (minisign's format: Ed25519 of the
/// BLAKE2b-512 of the file, and of the trusted comment).
/// key      a public key as minisign prints it, or the file that holds it.
/// Throws   Error{kInput} for a key that is none, for no signature, another key's, or one of other bytes.
/// Cost     one pass over the file, at some 1 GB/s.
void expect_signed(const std::filesystem::path& store, const std::string& key);

}  // namespace freshet::store
