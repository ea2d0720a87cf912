// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace cinch {

/// Bad input. what() is one line: file, place and reason, ready to print.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;

    static InputError in_file(const std::string& file, const std::string& reason)
    {
        return InputError(file + ": " + reason);
    }
    static InputError at_line(const std::string& file, std::size_t line, const std::string& reason)
    {
        return InputError(file + ":" + std::to_string(line) + ": " + reason);
    }
    static InputError at_byte(const std::string& file, std::size_t byte, const std::string& reason)
    {
        return InputError(file + ": byte " + std::to_string(byte) + ": " + reason);
    }
};

} // namespace cinch
