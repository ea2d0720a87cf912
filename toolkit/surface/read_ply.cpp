// SPDX-License-Identifier: Apache-2.0
// PLY: ascii, binary little endian, binary big endian. Elements and properties in any order; only x, y, z of `vertex`
// and vertex_indices (or vertex_index) of `face` and `tristrips` are used, the others are passed over.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "cinch/environment.hpp"
#include "toolkit/surface/left_out.hpp"
#include "toolkit/surface/ply_header.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

using namespace ply;

// Reads scalars of the body in file order, for all three formats.
class Body {
public:
    Body(std::string_view bytes, const std::string& file, const Header& header)
        : format_(header.format), bytes_(bytes), file_(file), at_(header.body), text_(bytes.substr(header.body), file),
          first_line_(header.body_line)
    {
    }

    /// Whether anything but blanks is left; nothing may be read after that.
    bool has_more()
    {
        return format_ == Format::ascii ? !text_.word().empty() || text_.next_line() : at_ < bytes_.size();
    }
    std::size_t bytes_left() const { return format_ == Format::ascii ? text_.bytes_left() : bytes_.size() - at_; }

    /// One scalar as a double; exact for every PLY type.
    double number(Scalar type, const char* what)
    {
        if (format_ == Format::ascii)
            return ascii_number(type, what);
        const std::size_t size = scalar_bytes[static_cast<int>(type)];
        last_ = at_;
        if (bytes_.size() - at_ < size)
            fail(std::string("the file ends where ") + what + " was expected");
        std::uint64_t raw = 0;
        for (std::size_t i = 0; i < size; ++i)
            raw = raw << 8 | static_cast<unsigned char>(bytes_[at_ + (format_ == Format::big ? i : size - 1 - i)]);
        at_ += size;
        switch (type) {
        case Scalar::i8:
            return static_cast<std::int8_t>(raw);
        case Scalar::u8:
            return static_cast<std::uint8_t>(raw);
        case Scalar::i16:
            return static_cast<std::int16_t>(raw);
        case Scalar::u16:
            return static_cast<std::uint16_t>(raw);
        case Scalar::i32:
            return static_cast<std::int32_t>(raw);
        case Scalar::u32:
            return static_cast<std::uint32_t>(raw);
        case Scalar::f32:
            return std::bit_cast<float>(static_cast<std::uint32_t>(raw));
        case Scalar::f64:
            return std::bit_cast<double>(raw);
        }
        return 0;
    }

    [[noreturn]] void fail(const std::string& reason) const
    {
        if (format_ == Format::ascii)
            throw InputError::at_line(file_, first_line_ + text_.line(), reason);
        throw InputError::at_byte(file_, last_, reason);
    }

private:
    double ascii_number(Scalar type, const char* what)
    {
        try {
            const std::string_view word = text_.word_across_lines(what);
            if (type >= Scalar::f32)
                return text_.number(word, what);
            return static_cast<double>(text_.integer(word, what));
        } catch (const InputError& error) { // its line counts from the body
            const std::string text = error.what();
            const std::size_t place = file_.size() + 1, colon = text.find(": ", place);
            fail(text.substr(colon + 2));
        }
    }

    Format format_;
    std::string_view bytes_;
    std::string file_;
    std::size_t at_, last_ = 0;
    TextScan text_;
    std::size_t first_line_;
};

// The fewest bytes that one item of the element can take; 0 if it has no properties.
std::size_t smallest_item(const Element& element, Format format)
{
    std::size_t bytes = 0;
    for (const Property& p : element.properties)
        bytes += format == Format::ascii ? 2 : scalar_bytes[static_cast<int>(p.list_size_type.value_or(p.type))];
    return bytes;
}

std::uint64_t list_size(Body& body, const Property& property)
{
    const double size = body.number(*property.list_size_type, "the size of a list");
    if (size < 0)
        body.fail("a list of negative size " + std::to_string(static_cast<std::int64_t>(size)));
    return static_cast<std::uint64_t>(size);
}

void read_vertex(Body& body, const Element& element, const int (&axis_property)[3], TriangleMesh& mesh)
{
    Vec3 v = Vec3::Zero();
    for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const Property& property = element.properties[static_cast<std::size_t>(p)];
        if (property.list_size_type) {
            for (std::uint64_t size = list_size(body, property); size > 0; --size)
                body.number(property.type, "a list item");
            continue;
        }
        const double value = body.number(property.type, "a vertex property");
        for (int axis = 0; axis < 3; ++axis)
            if (axis_property[axis] == p) {
                if (!std::isfinite(value))
                    body.fail("a coordinate of vertex " + std::to_string(mesh.vertices.size()) + " is not finite");
                v[axis] = value;
            }
    }
    mesh.vertices.push_back(v);
}

// What a list of vertex indices means.
enum class Meaning {
    polygon,
    strips, ///< triangle strips one after the other, each ended by -1 or the end of the list
    none,   ///< no index of a vertex
    unknown ///< an element that names vertices and is neither `face` nor `tristrips`
};

struct Polygons {
    std::vector<Triangle> triangles;
    std::size_t small_faces = 0, small_strips = 0, small_others = 0; ///< of fewer than three vertices
    std::vector<std::uint32_t> polygon;                              // scratch
};

void add_fan(Polygons& out)
{
    out.small_faces += out.polygon.size() < 3;
    for (std::size_t i = 2; i < out.polygon.size(); ++i)
        out.triangles.push_back({out.polygon[0], out.polygon[i - 1], out.polygon[i]});
}

// Every second triangle of a strip turns the other way, so two corners are swapped. Degenerate ones, by which strips
// are stitched together, are kept as all degenerate triangles are.
void end_strip(Polygons& out)
{
    out.small_strips += out.polygon.size() == 1 || out.polygon.size() == 2; // between two ends there is no strip
    for (std::size_t i = 2; i < out.polygon.size(); ++i) {
        const std::uint32_t a = out.polygon[i - 2], b = out.polygon[i - 1], c = out.polygon[i];
        out.triangles.push_back(i % 2 == 0 ? Triangle{a, b, c} : Triangle{b, a, c});
    }
    out.polygon.clear();
}

// -1, or what it becomes in a type without a sign, if no vertex has that index.
bool ends_strip(double index, Scalar type, std::uint64_t vertices)
{
    const double unsigned_end = type == Scalar::u8    ? 0xff
                                : type == Scalar::u16 ? 0xffff
                                : type == Scalar::u32 ? 0xffffffff
                                                      : -1;
    return index == -1 || (index == unsigned_end && index >= static_cast<double>(vertices));
}

void read_face(Body& body, const Element& element, std::size_t index_property, Meaning meaning, std::uint64_t vertices,
               Polygons& out)
{
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        if (!property.list_size_type) {
            body.number(property.type, "a property");
            continue;
        }
        const std::uint64_t size = list_size(body, property);
        out.polygon.clear();
        for (std::uint64_t i = 0; i < size; ++i) {
            if (p != index_property) {
                body.number(property.type, "a list item");
                continue;
            }
            const double index = body.number(property.type, "a vertex index");
            if (meaning == Meaning::strips && ends_strip(index, property.type, vertices)) {
                end_strip(out);
                continue;
            }
            if (!(index >= 0 && index < static_cast<double>(vertices)))
                body.fail("vertex index " + std::to_string(static_cast<std::int64_t>(index)) +
                          " is out of range; the file declares " + std::to_string(vertices) + " vertices");
            out.polygon.push_back(static_cast<std::uint32_t>(index));
        }
        if (p != index_property)
            continue;
        if (meaning == Meaning::unknown && size >= 3)
            body.fail("element '" + printable(element.name) + "' has a list of " + std::to_string(size) +
                      " vertices; surfaces are read from 'face' and 'tristrips' alone");
        if (meaning == Meaning::unknown)
            ++out.small_others;
        else if (meaning == Meaning::polygon)
            add_fan(out);
        else
            end_strip(out);
    }
}

// Lists of an element of such a name are lines, whatever their length.
bool is_line(std::string_view element)
{
    return element.starts_with("edge") || element.starts_with("line") || element.starts_with("polyline") ||
           element.starts_with("curve");
}

// The list of vertex indices, or the number of properties if there is none.
std::size_t index_list(const Element& element)
{
    std::size_t found = element.properties.size();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        if (property.list_size_type && property.type < Scalar::f32 &&
            (property.name == "vertex_indices" || property.name == "vertex_index"))
            found = p;
    }
    return found;
}

} // namespace

MeshFile parse_ply(std::string_view bytes, const std::string& file)
{
    require_default_arithmetic();
    const Header header = read_header(bytes, file);
    const auto is_vertices = [](const Element& e) { return e.name == "vertex"; };
    const auto vertex_element = std::find_if(header.elements.begin(), header.elements.end(), is_vertices);
    if (vertex_element == header.elements.end())
        throw InputError::in_file(file, "the header declares no element 'vertex'");
    if (std::count_if(header.elements.begin(), header.elements.end(), is_vertices) > 1)
        throw InputError::in_file(file, "the header declares the element 'vertex' twice");

    Body body(bytes, file, header);
    MeshFile out;
    Polygons faces;
    std::string not_read;
    for (const Element& element : header.elements) {
        const std::size_t least = smallest_item(element, header.format);
        const bool is_vertex = &element == &*vertex_element, is_face = element.name == "face",
                   is_strips = element.name == "tristrips";
        const std::size_t indices = index_list(element);
        const bool has_indices = indices < element.properties.size();
        if ((is_face || is_strips) && !has_indices)
            throw InputError::in_file(file, "element '" + element.name + "' has no integer list 'vertex_indices'");
        if (!is_vertex && !is_face && !is_strips && element.count > 0 && (!has_indices || is_line(element.name)))
            not_read += (not_read.empty() ? "'" : ", '") + printable(element.name) + "'";
        if (least == 0 && !is_vertex)
            continue; // nothing of it is in the file
        if (least > 0 && element.count > 0 && element.count - 1 > body.bytes_left() / least)
            throw InputError::in_file(file, "element '" + printable(element.name) + "' declares " +
                                                std::to_string(element.count) + " items, but only " +
                                                std::to_string(body.bytes_left()) + " bytes follow");
        if (is_vertex) {
            int axes[3] = {-1, -1, -1};
            for (std::size_t p = 0; p < element.properties.size(); ++p)
                for (int axis = 0; axis < 3; ++axis)
                    if (!element.properties[p].list_size_type &&
                        element.properties[p].name == std::string(1, static_cast<char>('x' + axis)))
                        axes[axis] = static_cast<int>(p);
            if (axes[0] < 0 || axes[1] < 0 || axes[2] < 0)
                throw InputError::in_file(file, "element 'vertex' lacks one of the properties x, y and z");
            out.mesh.vertices.reserve(std::min<std::uint64_t>(element.count, body.bytes_left() / least + 1));
            for (std::uint64_t i = 0; i < element.count; ++i)
                read_vertex(body, element, axes, out.mesh);
            continue;
        }
        const Meaning meaning = is_face                                 ? Meaning::polygon
                                : is_strips                             ? Meaning::strips
                                : has_indices && !is_line(element.name) ? Meaning::unknown
                                                                        : Meaning::none;
        for (std::uint64_t i = 0; i < element.count; ++i)
            read_face(body, element, meaning == Meaning::none ? element.properties.size() : indices, meaning,
                      vertex_element->count, faces);
    }
    out.mesh.triangles = std::move(faces.triangles);
    note_left_out(
        {{faces.small_faces, "face of fewer than three vertices", "faces of fewer than three vertices"},
         {faces.small_strips, "strip of fewer than three vertices", "strips of fewer than three vertices"},
         {faces.small_others, "element of fewer than three vertices", "elements of fewer than three vertices"}},
        out.notes);
    if (!not_read.empty())
        out.notes.push_back("not read, as no surface: " + not_read);
    const std::size_t left = body.bytes_left();
    if (body.has_more())
        out.notes.push_back(std::to_string(left) + (left == 1 ? " byte follows" : " bytes follow") +
                            " the last element that the header declares; not read");
    return out;
}

} // namespace cinch
