// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_document.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

// Throws the position of what is no base64.
std::string base64_decoded(std::string_view text)
{
    while (text.ends_with('='))
        text.remove_suffix(1);
    std::string out;
    out.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                          : c >= 'a' && c <= 'z' ? c - 'a' + 26
                          : c >= '0' && c <= '9' ? c - '0' + 52
                          : c == '+'             ? 62
                          : c == '/'             ? 63
                                                 : -1;
        if (digit < 0)
            throw i;
        group = group << 6 | static_cast<std::uint32_t>(digit);
        if (i % 4 == 3)
            for (int shift : {16, 8, 0})
                out += static_cast<char>(group >> shift & 255);
    }
    if (text.size() % 4 == 3)
        out += {static_cast<char>(group >> 10 & 255), static_cast<char>(group >> 2 & 255)};
    else if (text.size() % 4 == 2)
        out += static_cast<char>(group >> 4 & 255);
    return out;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

// Where an URI's file lies: under its decoded name, or, as some programs write it, under the name itself.
fs::path path_of(const std::string& uri, const std::string& file)
{
    const fs::path folder = fs::path(file).parent_path(), decoded = folder / percent_decoded(uri);
    std::error_code error;
    return !fs::exists(decoded, error) && fs::exists(folder / uri, error) ? folder / uri : decoded;
}

// The library says "[json.exception.parse_error.101] parse error at line 1, column 2: <why>; last read: '<some of the
// file>'; expected ...".
std::string reason_of(const nlohmann::json::exception& error)
{
    std::string what = error.what();
    if (const auto end = what.find("] "); what.starts_with('[') && end != std::string::npos)
        what.erase(0, end + 2);
    if (const auto quoted = what.find("; last read: '"); quoted != std::string::npos) {
        const auto end = what.rfind('\'');
        what.erase(quoted, end + 1 - quoted);
    }
    return one_line(what);
}

std::uint32_t word(std::string_view bytes, std::size_t at)
{
    std::uint32_t out = 0;
    for (std::size_t i = 4; i-- > 0;)
        out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
    return out;
}

} // namespace

std::string one_line(std::string_view text)
{
    std::string out;
    for (const char c : text)
        out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return out;
}

std::string percent_decoded(std::string_view uri)
{
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1,
                  low = high < 0 ? -1 : hex_digit(uri[i + 2]);
        out += low < 0 ? uri[i] : static_cast<char>(16 * high + low);
        i += low < 0 ? 0 : 2;
    }
    return out;
}

void GltfValue::fail(const std::string& reason) const
{
    throw InputError::in_file(*file_, (place_.empty() ? "" : named() + " ") + reason);
}

void GltfValue::expected(const char* what) const
{
    fail(std::string("is ") + json_->type_name() + ", expected " + what);
}

std::string GltfValue::named() const
{
    if (!json_->is_object())
        return place_;
    const auto name = json_->find("name");
    return name == json_->end() || !name->is_string() || name->get_ref<const std::string&>().empty()
               ? place_
               : place_ + " '" + printable(name->get_ref<const std::string&>()) + "'";
}

std::optional<GltfValue> GltfValue::find(const char* key) const
{
    if (!json_->is_object())
        expected("an object");
    const auto found = json_->find(key);
    if (found == json_->end())
        return std::nullopt;
    return GltfValue(*file_, *found, place_.empty() ? key : place_ + "." + key);
}

GltfValue GltfValue::operator[](const char* key) const
{
    if (auto found = find(key))
        return *found;
    fail(std::string("has no '") + key + "'");
}

std::vector<std::string> GltfValue::keys() const
{
    if (!json_->is_object())
        expected("an object");
    std::vector<std::string> out;
    for (const auto& item : json_->items())
        out.push_back(item.key());
    return out;
}

std::size_t GltfValue::size() const
{
    if (!json_->is_array())
        expected("an array");
    return json_->size();
}

GltfValue GltfValue::operator[](std::size_t i) const
{
    if (i >= size())
        fail("has " + std::to_string(size()) + " elements, not one of index " + std::to_string(i));
    return {*file_, (*json_)[i], place_ + "[" + std::to_string(i) + "]"};
}

double GltfValue::number() const
{
    if (!json_->is_number())
        expected("a number");
    return json_->get<double>();
}

std::size_t GltfValue::index() const
{
    const double x = number(); // 2 may be written 2.0
    if (!(x >= 0 && x < 0x1p53 && x == std::floor(x)))
        fail("is " + one_line(json_->dump()) + ", expected an integer from 0");
    return static_cast<std::size_t>(x);
}

const std::string& GltfValue::text() const
{
    if (!json_->is_string())
        expected("a string");
    return json_->get_ref<const std::string&>();
}

bool GltfValue::truth() const
{
    if (!json_->is_boolean())
        expected("true or false");
    return json_->get<bool>();
}

std::optional<std::size_t> GltfValue::index_of(const char* key) const
{
    const auto found = find(key);
    return found ? std::optional(found->index()) : std::nullopt;
}

std::size_t GltfValue::index_or(const char* key, std::size_t otherwise) const
{
    return index_of(key).value_or(otherwise);
}

std::string GltfValue::text_or(const char* key, const std::string& otherwise) const
{
    const auto found = find(key);
    return found ? found->text() : otherwise;
}

bool GltfValue::truth_or(const char* key, bool otherwise) const
{
    const auto found = find(key);
    return found ? found->truth() : otherwise;
}

std::vector<double> GltfValue::numbers(std::size_t count) const
{
    if (size() != count)
        fail("has " + std::to_string(size()) + " numbers, expected " + std::to_string(count));
    std::vector<double> out;
    for (std::size_t i = 0; i < count; ++i)
        out.push_back((*this)[i].number());
    return out;
}

GltfDocument::GltfDocument(std::string_view bytes, const std::string& file, const Decompression* decoders)
    : file_(file), decompression_(decoders), bytes_(bytes.size())
{
    std::string_view text = bytes;
    if (bytes.starts_with("glTF"))
        split_binary(bytes, text);
    try {
        root_ = nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw InputError::in_file(file, "is not valid JSON: " + reason_of(error));
    }
    if (!root_.is_object())
        throw InputError::in_file(file, "is no glTF file: its JSON is no object");
    const auto asset = root().find("asset");
    if (!asset || !asset->has("version"))
        throw InputError::in_file(file, "is no glTF file: it has no asset.version");
    for (const char* key : {"version", "minVersion"}) {
        const std::string version = asset->text_or(key, "2.0");
        if (std::string_view(key) == "version" ? version != "2" && !version.starts_with("2.") : version != "2.0")
            throw InputError::in_file(file, std::string("needs glTF ") + printable(version) + "; 2.0 is supported");
    }
    buffers_.resize(count("buffers"));
    for (std::size_t i = 0; i < buffers_.size(); ++i)
        if (const auto uri = at("buffers", i).find("uri"); uri && !is_data_uri(uri->text())) {
            std::error_code error;
            const std::uintmax_t size = fs::file_size(path_of(uri->text(), file), error);
            bytes_ += error ? 0 : size;
        }
}

// A .glb file: 12 bytes of header, then chunks, each with its length and kind.
void GltfDocument::split_binary(std::string_view bytes, std::string_view& text)
{
    auto fail = [&](const std::string& reason) { throw InputError::in_file(file_, reason); };
    if (bytes.size() < 20)
        fail("ends within its header");
    if (word(bytes, 4) != 2)
        fail("is version " + std::to_string(word(bytes, 4)) + " of binary glTF; 2 is supported");
    const std::size_t length = word(bytes, 8);
    if (length > bytes.size())
        fail("is cut off: it declares " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()));
    bool first = true;
    for (std::size_t at = 12; at + 8 <= length; first = false) {
        const std::size_t size = word(bytes, at);
        const std::string_view kind = bytes.substr(at + 4, 4);
        at += 8;
        if (size > length - at)
            fail("has a chunk of " + std::to_string(size) + " bytes at byte " + std::to_string(at - 8) + "; " +
                 std::to_string(length - at) + " are left");
        if (first && kind != "JSON")
            fail("begins with a chunk that is not JSON");
        if (first) {
            text = bytes.substr(at, size);
            while (text.ends_with('\0')) // padding is blanks; some programs write zeros
                text.remove_suffix(1);
        } else if (!has_binary_chunk_ && kind == std::string_view("BIN\0", 4)) {
            binary_chunk_ = bytes.substr(at, size);
            has_binary_chunk_ = true;
        }
        at += size;
    }
    if (first)
        fail("has no chunk of JSON");
}

std::size_t GltfDocument::count(const char* list) const
{
    const auto found = root().find(list);
    return found ? found->size() : 0;
}

GltfValue GltfDocument::at(const char* list, std::size_t i) const
{
    if (i >= count(list))
        throw InputError::in_file(file_, std::string(list) + "[" + std::to_string(i) + "] does not exist; there are " +
                                             std::to_string(count(list)));
    return root()[list][i];
}

const std::string& GltfDocument::buffer(std::size_t i)
{
    const GltfValue value = at("buffers", i); // says so where it does not exist
    if (!buffers_[i]) {
        std::string data = load(i);
        const std::size_t length = value["byteLength"].index();
        if (data.size() < length)
            value.fail("declares " + std::to_string(length) + " bytes, but there are " + std::to_string(data.size()));
        data.resize(length);
        buffers_[i] = std::move(data);
    }
    return *buffers_[i];
}

std::string GltfDocument::load(std::size_t i) const
{
    const GltfValue value = at("buffers", i);
    const auto given = value.find("uri");
    if (!given) {
        if (i != 0 || !has_binary_chunk_)
            value.fail("has no data");
        return binary_chunk_;
    }
    const std::string& uri = given->text();
    if (!is_data_uri(uri)) {
        if (uri.find("://") != std::string::npos)
            value.fail("lies elsewhere, at " + one_line(uri) + "; files beside this one are read");
        try {
            return read_bytes(path_of(uri, file_));
        } catch (const InputError& error) {
            throw InputError::in_file(file_, value.place() + " cannot be read: " + one_line(error.what()));
        }
    }
    const auto comma = uri.find(',');
    if (comma == std::string::npos)
        value.fail("has a data URI without a comma");
    const std::string_view data = std::string_view(uri).substr(comma + 1);
    if (!std::string_view(uri).substr(0, comma).ends_with(";base64"))
        return percent_decoded(data);
    try {
        return base64_decoded(data);
    } catch (const std::size_t at) {
        value.fail("has a data URI that is no base64 at character " + std::to_string(comma + 1 + at));
    }
}

} // namespace cinch
