// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/line_file.hpp"

#include <array>

#include <zlib.h>

#include "cinch/surface.hpp"
#include "experiments/report/whole_file.hpp"

namespace cinch {

struct LineFile::Handle {
    explicit Handle(const std::string& name) : file(name), is_compressed(name.ends_with(".gz"))
    {
        constexpr int fast = 1, gzip = 15 + 16, memory = 8;
        if (is_compressed && deflateInit2(&stream, fast, Z_DEFLATED, gzip, memory, Z_DEFAULT_STRATEGY) != Z_OK)
            throw InputError::in_file(name, "cannot be compressed: out of memory");
    }
    ~Handle()
    {
        if (is_compressed)
            deflateEnd(&stream);
    }
    void write(std::string_view text, int flush)
    {
        if (!is_compressed)
            return file.write(text);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data())); // which zlib only reads
        stream.avail_in = static_cast<uInt>(text.size());
        do {
            stream.next_out = reinterpret_cast<Bytef*>(out.data());
            stream.avail_out = static_cast<uInt>(out.size());
            deflate(&stream, flush); // cannot fail: state and buffers are as they must be
            file.write({out.data(), out.size() - stream.avail_out});
        } while (stream.avail_out == 0);
    }

    WholeFile file;
    bool is_compressed;
    z_stream stream = {};
    std::array<char, 1 << 16> out;
};

LineFile::LineFile(const std::string& name) : handle_(std::make_unique<Handle>(name)) {}

LineFile::~LineFile() = default;

void LineFile::line(std::string_view text)
{
    handle_->write(text, Z_NO_FLUSH);
    handle_->write("\n", Z_NO_FLUSH);
}

void LineFile::commit()
{
    if (handle_->is_compressed)
        handle_->write("", Z_FINISH);
    handle_->file.commit();
}

} // namespace cinch
