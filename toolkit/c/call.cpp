// SPDX-License-Identifier: Apache-2.0
#include "toolkit/c/call.hpp"

#include <new>
#include <system_error>

#include "cinch/surface.hpp"
#include "toolkit/c/registry.hpp"

namespace cinch::c {
namespace {

struct Message {
    std::string text;
    const char* shown = "";
};
thread_local Message message;

cinch_status says(cinch_status status, const char* why) noexcept
{
    try {
        message.text = why;
        message.shown = message.text.c_str();
    } catch (...) {
        message.shown = "there is no memory left";
    }
    return status;
}

} // namespace

cinch_status failed() noexcept
{
    try {
        throw;
    } catch (const Fault& fault) {
        return says(fault.status(), fault.what());
    } catch (const InputError& error) {
        return says(CINCH_ERROR_INPUT, error.what());
    } catch (const std::invalid_argument& error) {
        return says(CINCH_ERROR_ARGUMENT, error.what());
    } catch (const std::out_of_range& error) {
        return says(CINCH_ERROR_ARGUMENT, error.what());
    } catch (const std::length_error& error) {
        return says(CINCH_ERROR_LENGTH, error.what());
    } catch (const std::logic_error& error) {
        return says(CINCH_ERROR_ORDER, error.what());
    } catch (const std::system_error& error) { // of files, threads and locks
        return says(CINCH_ERROR_INPUT, error.what());
    } catch (const std::runtime_error& error) {
        return says(CINCH_ERROR_RUNTIME, error.what());
    } catch (const std::bad_alloc&) {
        return says(CINCH_ERROR_MEMORY, "there is no memory left");
    } catch (const std::exception& error) {
        return says(CINCH_ERROR_INTERNAL, error.what());
    } catch (...) {
        return says(CINCH_ERROR_INTERNAL, "an exception of unknown type");
    }
}

} // namespace cinch::c

const char* cinch_error_message(void) { return cinch::c::message.shown; }

cinch_status cinch_free(void* handle)
{
    return cinch::c::call([&] { cinch::c::free_handle(handle); });
}
