// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/records/row_folder.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/records/shard_text.hpp"
#include "experiments/report/file_lock.hpp"

namespace cinch {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void cannot(const fs::path& file, int error)
{
    throw InputError::in_file(file.string(), fmt::format("cannot be written: {}", std::strerror(error)));
}

} // namespace

struct ShardFile::Handle {
    Handle(fs::path path, const Campaign& campaign, const Shard& of)
        : name(std::move(path)), shard(of),
          lock(name.string() + ".lock", name.string(),
               "another process computes this shard; wait for it, or give each shard to one process")
    {
        file = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (file < 0)
            cannot(name, errno);
        std::size_t keep = 0;
        if (auto found = read_shard(name)) {
            if (const std::string what = difference(found->campaign, campaign); !what.empty())
                throw InputError::in_file(name.string(), "has rows of " + what + "; give this run a folder of its own");
            if (found->shard.index != shard.index || found->shard.count != shard.count)
                throw InputError::in_file(name.string(), "says that it is of another shard");
            cells = std::move(found->cells);
            keep = found->whole_bytes;
        }
        if (::ftruncate(file, static_cast<off_t>(keep)) != 0 || ::lseek(file, 0, SEEK_END) < 0)
            cannot(name, errno);
        size = keep;
        if (keep == 0)
            append(first_line(campaign, shard));
    }
    ~Handle() { ::close(file); }

    // All of it or, where the disk is full, nothing.
    void append(std::string_view text)
    {
        for (std::size_t written = 0; written < text.size();) {
            const ssize_t n = ::write(file, text.data() + written, text.size() - written);
            if (n < 0 && errno == EINTR)
                continue;
            if (n < 0) {
                const int error = errno;
                if (::ftruncate(file, static_cast<off_t>(size)) != 0) // the next run cuts off what is left of it
                    ::lseek(file, 0, SEEK_END);
                cannot(name, error);
            }
            written += static_cast<std::size_t>(n);
        }
        size += text.size();
    }

    fs::path name;
    Shard shard;
    FileLock lock;
    int file = -1;
    std::size_t size = 0;
    std::map<std::size_t, Rows> cells;
};

ShardFile::ShardFile(const fs::path& folder, const Campaign& campaign, const Shard& shard)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw InputError::in_file(folder.string(), "cannot be made a folder: " + error.message());
    handle_ = std::make_unique<Handle>(file_of(folder, shard), campaign, shard);
}

ShardFile::~ShardFile() = default;
ShardFile::ShardFile(ShardFile&&) noexcept = default;

const std::map<std::size_t, Rows>& ShardFile::cells() const { return handle_->cells; }

void ShardFile::add(std::size_t cell, const Rows& rows)
{
    handle_->append(cell_line(cell, rows));
    handle_->cells[cell] = rows;
}

} // namespace cinch
