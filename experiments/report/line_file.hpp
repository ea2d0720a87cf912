// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace cinch {

/// A text file written line by line, compressed if its name ends in ".gz", and there when it is whole (whole_file.hpp).
/// Errors throw InputError.
class LineFile {
public:
    explicit LineFile(const std::string& name);
    ~LineFile();
    void line(std::string_view text);
    void commit(); ///< without it nothing has happened

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

} // namespace cinch
