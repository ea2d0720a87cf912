// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/file_lock.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "cinch/surface.hpp"

namespace cinch {

FileLock::FileLock(const std::filesystem::path& lock, const std::string& of, const std::string& taken)
    : file_(open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644))
{
    if (file_ < 0)
        throw InputError::in_file(of, std::string("cannot be written: ") + std::strerror(errno));
    if (flock(file_, LOCK_EX | LOCK_NB) == 0)
        return;
    const int error = errno;
    close(file_);
    throw InputError::in_file(of,
                              error == EWOULDBLOCK ? taken : std::string("cannot be locked: ") + std::strerror(error));
}

FileLock::~FileLock() { close(file_); }

} // namespace cinch
