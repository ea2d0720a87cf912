// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace cinch {

/// Held by one process at a time, and free again when it ends, however it ends. The file is made if it is not there,
/// and stays.
class FileLock {
public:
    /// Throws InputError about `of`: "cannot be written" if there can be no lock, `taken` if another process holds it.
    FileLock(const std::filesystem::path& lock, const std::string& of, const std::string& taken);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    int file_;
};

} // namespace cinch
