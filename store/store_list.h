// store/store_list.h — a file that names several stores, which are read as one.
#pragma once

#include <filesystem>
#include <vector>

namespace freshet::store {

/// Whether a name is that of a list: it ends in ".stores".
bool is_store_list(const std::filesystem::path& path);

/// A store a line, relative to the list's folder; empty lines, and those that begin with #, say nothing.
/// Throws Error{kInput} when it cannot be read or names none.
std::vector<std::filesystem::path> read_store_list(const std::filesystem::path& path);

/// The stores that a name stands for: those of a list, or itself. Throws as read_store_list.
std::vector<std::filesystem::path> stores_named(const std::filesystem::path& path);

/// Throws Error{kUsage} for a list, naming its stores: what changes a store works on one.
void expect_one_store(const std::filesystem::path& path);
/// Throws Error{kUsage} for a new store that would be taken for a list.
void expect_store_name(const std::filesystem::path& path);

}  // namespace freshet::store
