// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/whole_file.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <mutex>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "toolkit/surface/input_error.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t buffer_bytes = 1 << 16;

std::string because(const std::string& what, int error) { return what + ": " + std::strerror(error) + (error == ENOSPC || error == EDQUOT ? "; the disk is full" : ""); }

/// A file's identity: the same for all its names and links.
struct Identity {
    dev_t device;
    ino_t inode;
    auto operator<=>(const Identity&) const = default;
};

/// What this process reads and writes: nothing may be both, or written twice.
struct Known {
    std::mutex mutex;
    std::set<Identity> inputs;
    std::set<std::string> targets; ///< of files that are being written, as target_of says
};
Known& known()
{
    static Known all;
    return all;
}

/// Names of partial files where a signal handler can read them. A slot is taken, written, then shown.
struct Slot {
    std::atomic<bool> taken = false, shown = false;
    char part[PATH_MAX] = {};
};
Slot slots[64];

int show_to_handler(const std::string& part)
{
    if (part.size() < PATH_MAX)
        for (int i = 0; i < static_cast<int>(std::size(slots)); ++i)
            if (!slots[i].taken.exchange(true)) {
                std::memcpy(slots[i].part, part.c_str(), part.size() + 1);
                slots[i].shown = true;
                return i;
            }
    return -1; // so many at once: a signal leaves it beside its place
}

void hide_from_handler(int slot)
{
    if (slot < 0)
        return;
    slots[slot].shown = false;
    slots[slot].taken = false;
}

/// Where a name leads, links followed, also to what is not there yet; absolute, so that two names of one place compare.
fs::path target_of(fs::path name)
{
    std::error_code error;
    for (int links = 0; fs::is_symlink(fs::symlink_status(name, error)); ++links) {
        const fs::path next = fs::read_symlink(name, error);
        if (error || links == 40)
            throw InputError::in_file(name.string(), "cannot be written: the link leads nowhere");
        name = name.parent_path() / next; // an absolute one replaces all of it
    }
    const fs::path folder = fs::canonical(name.has_parent_path() ? name.parent_path() : fs::path("."), error);
    if (error)
        throw InputError::in_file(name.string(), because("cannot be written", error.value()));
    return folder / name.filename();
}

std::string random_letters()
{
    static std::random_device device;
    std::string out;
    for (int i = 0; i < 6; ++i)
        out += "abcdefghijklmnopqrstuvwxyz234567"[device() % 32];
    return out;
}

} // namespace

WholeFile::WholeFile(const fs::path& name) : name_(name.string())
{
    struct stat there = {};
    const bool exists = stat(name.c_str(), &there) == 0;
    if (exists && S_ISDIR(there.st_mode))
        throw InputError::in_file(name_, "cannot be written: it is a folder");
    for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) // its place is where this stream stands in the file
        if (struct stat open = {}; exists && S_ISREG(there.st_mode) && fstat(standard, &open) == 0 && open.st_dev == there.st_dev && open.st_ino == there.st_ino) {
            if ((file_ = fcntl(standard, F_DUPFD_CLOEXEC, 0)) < 0)
                fail(errno);
            return;
        }
    if (exists && !S_ISREG(there.st_mode)) {
        if ((file_ = open(name.c_str(), O_WRONLY | O_CLOEXEC)) < 0)
            fail(errno);
        return;
    }
    const fs::path target = target_of(name);
    {
        const std::lock_guard lock(known().mutex);
        if (exists && known().inputs.contains({there.st_dev, there.st_ino}))
            throw InputError::in_file(name_, "is an input of this command; the output needs another name");
        for (const std::string& other : known().targets) // by identity too: hard links
            if (struct stat is = {}; other == target || (exists && stat(other.c_str(), &is) == 0 && is.st_dev == there.st_dev && is.st_ino == there.st_ino))
                throw InputError::in_file(name_, "is named for two outputs; each needs a name of its own");
    }
    if (exists && access(name.c_str(), W_OK) != 0)
        fail(errno);
    const std::string folder = target.parent_path().string() + "/";
    std::string beside;
    for (int tries = 0; file_ < 0 && tries < 100; ++tries) {
        beside = folder + target.filename().string().substr(0, NAME_MAX - 12) + "." + random_letters() + ".part";
        file_ = open(beside.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666); // what the umask leaves, as for every new file
        if (file_ < 0 && errno != EEXIST)
            throw InputError::in_file(name_, because("cannot be written, nor any file beside it", errno));
    }
    if (file_ < 0)
        fail(EEXIST);
    target_ = target.string();
    part_ = std::move(beside);
    slot_ = show_to_handler(part_);
    if (exists) {
        if (fchown(file_, there.st_uid, there.st_gid) != 0 && fchown(file_, static_cast<uid_t>(-1), there.st_gid) != 0) {
            // Neither is ours to give: it becomes a file of the one who writes it.
        }
        fchmod(file_, there.st_mode & 07777);
    }
    const std::lock_guard lock(known().mutex);
    is_registered_ = known().targets.insert(target_).second;
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : name_(std::move(other.name_)), target_(std::move(other.target_)), part_(std::exchange(other.part_, {})), buffer_(std::move(other.buffer_)), file_(std::exchange(other.file_, -1)),
      slot_(std::exchange(other.slot_, -1)), is_registered_(std::exchange(other.is_registered_, false))
{
}

WholeFile::~WholeFile()
{
    if (file_ >= 0)
        close(file_);
    if (!part_.empty())
        unlink(part_.c_str());
    hide_from_handler(slot_);
    if (is_registered_) {
        const std::lock_guard lock(known().mutex);
        known().targets.erase(target_);
    }
}

void WholeFile::fail(int error) const { throw InputError::in_file(name_, because("cannot be written", error)); }

void WholeFile::flush()
{
    for (std::string_view left = buffer_; !left.empty();) {
        const ssize_t written = ::write(file_, left.data(), left.size());
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            fail(errno);
        left.remove_prefix(static_cast<std::size_t>(written));
    }
    buffer_.clear();
}

void WholeFile::write(std::string_view bytes)
{
    buffer_.append(bytes);
    if (buffer_.size() >= buffer_bytes)
        flush();
}

void WholeFile::commit()
{
    flush();
    if (part_.empty()) {
        if (close(std::exchange(file_, -1)) != 0 && errno != EINTR)
            fail(errno);
        return;
    }
    if (fsync(file_) != 0 && errno != EINVAL) // before the rename: else a crash could leave the name with nothing in it
        fail(errno);
    if (close(std::exchange(file_, -1)) != 0 && errno != EINTR)
        fail(errno);
    if (rename(part_.c_str(), target_.c_str()) != 0)
        fail(errno);
    part_.clear();
    hide_from_handler(std::exchange(slot_, -1));
    if (const int folder = open(fs::path(target_).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); folder >= 0) {
        fsync(folder); // the name; where that cannot be done, it comes when the system sees fit
        close(folder);
    }
}

void write_whole(const fs::path& name, std::string_view bytes)
{
    WholeFile file(name);
    file.write(bytes);
    file.commit();
}

void guard_input(const fs::path& file)
{
    struct stat is = {};
    if (stat(file.c_str(), &is) != 0 || !S_ISREG(is.st_mode))
        return;
    const std::lock_guard lock(known().mutex);
    for (const std::string& target : known().targets)
        if (struct stat there = {}; stat(target.c_str(), &there) == 0 && there.st_dev == is.st_dev && there.st_ino == is.st_ino)
            throw InputError::in_file(target, "is an input of this command; the output needs another name");
    known().inputs.insert({is.st_dev, is.st_ino});
}

void remove_partial_files() noexcept
{
    for (Slot& slot : slots)
        if (slot.shown)
            unlink(slot.part);
}

} // namespace cinch
