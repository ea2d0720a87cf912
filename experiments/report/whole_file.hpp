// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace cinch {

/// An output file that is there whole or not at all. It is written beside its place, as NAME.XXXXXX.part, and takes the
/// place when all of it is on the disk: whatever stops the program before, what stood there is untouched. A link's
/// target is replaced, not the link; mode and group of a file that was there are kept. What is no regular file (a pipe,
/// /dev/null, /dev/stdout) is written directly.
///
///     WholeFile file(name);   // before anything is computed: refuses what cannot be written, and what is an input
///     file.write(text);
///     file.commit();          // without it, nothing has happened
///
/// All throw InputError, which names the file and the reason.
class WholeFile {
public:
    explicit WholeFile(const std::filesystem::path& name);
    WholeFile(WholeFile&& other) noexcept;
    WholeFile& operator=(WholeFile&&) = delete;
    ~WholeFile(); ///< not committed: removes what was written, if nobody is to continue it

    /// For long runs: what is written stands as NAME.part, and stays when it is not committed, for another run to
    /// continue. This one begins with the first `bytes` that are there, of NAME.part or of NAME, whichever has so many
    /// with this FNV-1a checksum; 0: with nothing.
    static WholeFile continued(const std::filesystem::path& name, std::uint64_t bytes = 0, std::uint64_t checksum = 0);
    /// Where it is until it is committed.
    const std::string& part() const { return part_; }

    void write(std::string_view bytes);
    void sync(); ///< all that was written is on the disk
    void commit();

private:
    WholeFile() = default;
    bool open_directly(const std::filesystem::path& name);
    void enter(const std::filesystem::path& name);
    void leave();
    void keep_mode() const;
    void flush();
    [[noreturn]] void fail(int error) const;

    std::string name_;          ///< as the user gave it
    std::string target_, part_; ///< empty: written directly
    std::string buffer_;
    int file_ = -1;
    int slot_ = -1; ///< of the files that a signal removes
    bool is_registered_ = false, is_kept_ = false;
};

/// The whole of a small file at once.
void write_whole(const std::filesystem::path& name, std::string_view bytes);

/// Says that this file is read: from now on no WholeFile takes its place, by whatever name or link. Throws InputError
/// if one that is being written would. Files that are not there, and those that are no regular files, need no guard.
void guard_input(const std::filesystem::path& file);

/// Throws InputError if it is such a file: for names of which more follow later.
void refuse_input(const std::filesystem::path& output);

/// Removes the partial files of all WholeFiles. For signal handlers, right before the process ends: safe there.
void remove_partial_files() noexcept;

} // namespace cinch
