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

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cinch/surface.hpp"
#include "toolkit/surface/checksum.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t buffer_bytes = 1 << 16;

std::string because(const std::string& what, int error)
{
    return what + ": " + std::strerror(error) + (error == ENOSPC || error == EDQUOT ? "; the disk is full" : "");
}

/// What this process reads and writes, as absolute paths: nothing may be both, or written twice.
struct Known {
    std::mutex mutex;
    std::set<std::string> inputs;
    std::set<std::string> targets; ///< of files that are being written, as target_of says
};
Known& known()
{
    static Known all;
    return all;
}

/// Whether a path leads to this file, whatever its names and links.
bool is_same(const std::string& path, const struct stat& file)
{
    struct stat there = {};
    return stat(path.c_str(), &there) == 0 && there.st_dev == file.st_dev && there.st_ino == file.st_ino;
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

/// The FNV-1a checksum of a file's first bytes is this; false where there are fewer.
bool begins_with(int file, std::uint64_t bytes, std::uint64_t expected, WholeFile* copy = nullptr)
{
    std::string part(buffer_bytes, '\0');
    std::uint64_t sum = checksum({}), at = 0;
    while (at < bytes) {
        const ssize_t got =
            pread(file, part.data(), std::min<std::uint64_t>(part.size(), bytes - at), static_cast<off_t>(at));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        const std::string_view here(part.data(), static_cast<std::size_t>(got));
        sum = checksum(here, sum);
        if (copy)
            copy->write(here);
        at += here.size();
    }
    return sum == expected;
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

// True if the file is one to be written directly, and then it is open.
bool WholeFile::open_directly(const fs::path& name)
{
    struct stat there = {};
    if (stat(name.c_str(), &there) != 0)
        return false;
    if (S_ISDIR(there.st_mode))
        throw InputError::in_file(name_, "cannot be written: it is a folder");
    if (!S_ISREG(there.st_mode)) {
        file_ = open(name.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) // its place is where this stream stands in the file
            if (struct stat open = {};
                file_ < 0 && fstat(standard, &open) == 0 && open.st_dev == there.st_dev && open.st_ino == there.st_ino)
                file_ = fcntl(standard, F_DUPFD_CLOEXEC, 0);
        if (file_ < 0)
            return false;
    }
    if (file_ < 0)
        fail(errno);
    return true;
}

// Refuses what must not be replaced, else keeps other outputs from it.
void WholeFile::enter(const fs::path& name)
{
    refuse_input(name);
    const fs::path target = target_of(name);
    struct stat there = {};
    const bool exists = stat(name.c_str(), &there) == 0;
    if (exists && access(name.c_str(), W_OK) != 0)
        fail(errno);
    const std::lock_guard lock(known().mutex);
    for (const std::string& other : known().targets)
        if (other == target || (exists && is_same(other, there)))
            throw InputError::in_file(name_, "is named for two outputs; each needs a name of its own");
    target_ = target.string();
    is_registered_ = known().targets.insert(target_).second;
}

void WholeFile::keep_mode() const
{
    struct stat there = {};
    if (stat(target_.c_str(), &there) != 0)
        return;
    if (fchown(file_, there.st_uid, there.st_gid) != 0 && fchown(file_, static_cast<uid_t>(-1), there.st_gid) != 0) {
        // Neither is ours to give: it becomes a file of the one who writes it.
    }
    fchmod(file_, there.st_mode & 07777);
}

WholeFile::WholeFile(const fs::path& name) : WholeFile()
{
    name_ = name.string();
    if (open_directly(name))
        return;
    enter(name);
    const fs::path target = target_;
    const std::string beside = (target.parent_path() / target.filename().string().substr(0, NAME_MAX - 12)).string();
    std::string part;
    for (int tries = 0; file_ < 0 && (tries == 0 || errno == EEXIST) && tries < 100; ++tries) {
        part = beside + "." + random_letters() + ".part";
        file_ = open(part.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC,
                     0666); // what the umask leaves, as for every new file
    }
    if (file_ < 0)
        throw InputError::in_file(name_, because("cannot be written, nor any file beside it", errno));
    part_ = part;
    slot_ = show_to_handler(part_);
    keep_mode();
}

WholeFile WholeFile::continued(const fs::path& name, std::uint64_t bytes, std::uint64_t checksum)
{
    WholeFile out;
    out.name_ = name.string();
    out.is_kept_ = true;
    if (out.open_directly(name)) {
        if (bytes > 0)
            throw InputError::in_file(out.name_, "is no regular file, so nothing in it can be continued");
        return out;
    }
    out.enter(name);
    const std::string part = out.target_ + ".part";
    refuse_input(part);
    out.file_ = open(part.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (out.file_ < 0)
        throw InputError::in_file(out.name_, because("cannot be written, nor " + part, errno));
    if (flock(out.file_, LOCK_EX | LOCK_NB) != 0)
        throw InputError::in_file(out.name_, "another run is writing it, as " + part);
    out.part_ = part;
    auto cut = [&](std::uint64_t at) {
        if (ftruncate(out.file_, static_cast<off_t>(at)) != 0 || lseek(out.file_, static_cast<off_t>(at), SEEK_SET) < 0)
            out.fail(errno);
    };
    if (bytes == 0 || begins_with(out.file_, bytes, checksum)) {
        cut(bytes);
    } else { // then a run that came to its end is continued, for longer
        const int whole = open(out.target_.c_str(), O_RDONLY | O_CLOEXEC);
        const bool fits = whole >= 0 && begins_with(whole, bytes, checksum);
        if (fits) {
            cut(0);
            begins_with(whole, bytes, checksum, &out);
        }
        if (whole >= 0)
            close(whole);
        if (!fits)
            throw InputError::in_file(out.name_,
                                      fmt::format("does not have the {} bytes that are to be continued", bytes));
    }
    out.keep_mode();
    return out;
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : name_(std::move(other.name_)), target_(std::move(other.target_)), part_(std::exchange(other.part_, {})),
      buffer_(std::move(other.buffer_)), file_(std::exchange(other.file_, -1)), slot_(std::exchange(other.slot_, -1)),
      is_registered_(std::exchange(other.is_registered_, false)), is_kept_(other.is_kept_)
{
}

WholeFile::~WholeFile()
{
    struct stat now = {};
    const bool is_empty = file_ >= 0 && fstat(file_, &now) == 0 && now.st_size == 0;
    if (!part_.empty() && (!is_kept_ || is_empty))
        unlink(part_.c_str());
    hide_from_handler(slot_);
    if (file_ >= 0)
        close(file_);
    leave();
}

// Others may write there again.
void WholeFile::leave()
{
    if (!std::exchange(is_registered_, false))
        return;
    const std::lock_guard lock(known().mutex);
    known().targets.erase(target_);
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

void WholeFile::sync()
{
    flush();
    if (fsync(file_) != 0 && errno != EINVAL && errno != EROFS) // pipes have no disk
        fail(errno);
}

void WholeFile::commit()
{
    sync(); // before the rename: else a crash could leave the name with nothing in it
    if (part_.empty()) {
        if (close(std::exchange(file_, -1)) != 0 && errno != EINTR)
            fail(errno);
        return;
    }
    if (close(std::exchange(file_, -1)) != 0 && errno != EINTR)
        fail(errno);
    if (rename(part_.c_str(), target_.c_str()) != 0)
        fail(errno);
    part_.clear();
    leave();
    hide_from_handler(std::exchange(slot_, -1));
    if (const int folder = open(fs::path(target_).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        folder >= 0) {
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

void refuse_input(const fs::path& output)
{
    struct stat is = {};
    if (stat(output.c_str(), &is) != 0)
        return;
    const std::lock_guard lock(known().mutex);
    for (const std::string& input : known().inputs)
        if (is_same(input, is))
            throw InputError::in_file(output.string(), "is an input of this command; the output needs another name");
}

void guard_input(const fs::path& file)
{
    struct stat is = {};
    if (stat(file.c_str(), &is) != 0 || !S_ISREG(is.st_mode))
        return;
    const std::lock_guard lock(known().mutex);
    for (const std::string& target : known().targets)
        if (is_same(target, is))
            throw InputError::in_file(target, "is an input of this command; the output needs another name");
    known().inputs.insert(fs::absolute(file).string());
}

void remove_partial_files() noexcept
{
    for (Slot& slot : slots)
        if (slot.shown)
            unlink(slot.part);
}

} // namespace cinch
