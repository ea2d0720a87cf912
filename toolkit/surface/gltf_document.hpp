// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "cinch/io.hpp"

namespace cinch {

/// A value in a glTF file's JSON that knows its place, so that every complaint names it. Holds on to the document.
class GltfValue {
public:
    using Json = nlohmann::json;

    GltfValue(const std::string& file, const Json& json, std::string place)
        : file_(&file), json_(&json), place_(std::move(place))
    {
    }

    /// "nodes[3]", for messages; with the name that the file gives it, if any: "nodes[3] 'hand'".
    const std::string& place() const { return place_; }
    std::string named() const;
    [[noreturn]] void fail(const std::string& reason) const; ///< file, place, reason

    bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
    /// A member; where there is none, or this is no object: an error.
    GltfValue operator[](const char* key) const;
    std::optional<GltfValue> find(const char* key) const; ///< empty where there is none
    std::vector<std::string> keys() const;                ///< of an object
    GltfValue operator[](std::size_t i) const;            ///< of an array; else, and beyond its end, an error
    std::size_t size() const;                             ///< of an array

    std::size_t index() const; ///< an integer ≥ 0
    double number() const;
    const std::string& text() const;
    bool truth() const;
    /// Members that may be absent.
    std::size_t index_or(const char* key, std::size_t otherwise) const;
    std::string text_or(const char* key, const std::string& otherwise) const;
    bool truth_or(const char* key, bool otherwise) const;
    std::optional<std::size_t> index_of(const char* key) const;
    /// `N` numbers in an array, e.g. a translation.
    std::vector<double> numbers(std::size_t count) const;

private:
    [[noreturn]] void expected(const char* what) const;

    const std::string* file_;
    const Json* json_;
    std::string place_;
};

/// A .gltf or .glb file: its JSON, and its buffers, each read when it is wanted.
class GltfDocument {
public:
    /// `file` is for messages, and the buffers' files lie beside it. Throws InputError for what is no glTF 2.
    GltfDocument(std::string_view bytes, const std::string& file, const Decompression* decoders = nullptr);

    const std::string& file() const { return file_; }
    GltfValue root() const { return {file_, root_, ""}; }
    /// The number of elements of a list at the top: "nodes", "meshes", ...; and one of them, an error where there is
    /// none.
    std::size_t count(const char* list) const;
    GltfValue at(const char* list, std::size_t i) const;

    /// The bytes of a buffer, as many as it declares.
    const std::string& buffer(std::size_t i);
    /// How much data the file and the files beside it can hold: no count in the file is believed beyond it.
    std::uintmax_t bytes() const { return bytes_; }
    /// Null: none.
    const Decompression* decompression() const { return decompression_; }
    std::map<std::size_t, std::string> decoded_views; ///< by their number (gltf_compression.hpp)

private:
    void split_binary(std::string_view bytes, std::string_view& text);
    std::string load(std::size_t i) const;

    std::string file_;
    const Decompression* decompression_;
    nlohmann::json root_;
    std::string binary_chunk_;
    bool has_binary_chunk_ = false;
    std::vector<std::optional<std::string>> buffers_;
    std::uintmax_t bytes_ = 0;
};

/// A text from a file as one line, whole: control characters become question marks.
std::string one_line(std::string_view text);

/// An URI's path as a file name: %XX are bytes, all else, '+' too, stands for itself.
std::string percent_decoded(std::string_view uri);

} // namespace cinch
