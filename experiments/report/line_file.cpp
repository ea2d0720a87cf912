// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/line_file.hpp"

#include <utility>

#include <zlib.h>

#include "toolkit/surface/input_error.hpp"

namespace cinch {

struct LineFile::Handle {
    gzFile file;
};

LineFile::LineFile(const std::string& name) : name_(name)
{
    const gzFile file = gzopen(name.c_str(), name.ends_with(".gz") ? "wb1" : "wbT"); // fast; T: as it is
    if (!file)
        throw InputError::in_file(name, "cannot be written");
    gzbuffer(file, 1 << 18);
    handle_ = std::make_unique<Handle>(Handle{file});
}

LineFile::~LineFile()
{
    if (handle_)
        gzclose(handle_->file);
}

void LineFile::line(std::string_view text)
{
    if (gzwrite(handle_->file, text.data(), static_cast<unsigned>(text.size())) != static_cast<int>(text.size()) || gzputc(handle_->file, '\n') != '\n')
        throw InputError::in_file(name_, "writing failed; is the disk full?");
}

void LineFile::close()
{
    if (gzclose(std::exchange(handle_, nullptr)->file) != Z_OK)
        throw InputError::in_file(name_, "writing failed; is the disk full?");
}

} // namespace cinch
