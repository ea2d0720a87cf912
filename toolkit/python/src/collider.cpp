// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "cinch/collider.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/frames.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/options.hpp"
#include "toolkit/python/src/pairs.hpp"

namespace cinch::python {
namespace {

// What Python refers to, in C++'s hands: let go of with the GIL.
std::shared_ptr<py::object> held(py::object object)
{
    return {new py::object(std::move(object)), [](py::object* o) {
                const py::gil_scoped_acquire locked;
                delete o;
            }};
}

LazyOptions lazy_options(LazyOptions out, const py::kwargs& given, bool of_collider)
{
    for (const auto& [key, value] : given) {
        const auto name = py::cast<std::string>(key);
        if (name == "method")
            out.methods = methods_of(py::cast<std::string>(value));
        else if (name == "precision")
            out.precision = precision_of(py::cast<std::string>(value));
        else if (name == "rest_shape")
            out.rest_shape = rest_shape_of(py::cast<std::string>(value));
        else if (name == "update")
            out.update =
                choice<Update, 3>("update", py::cast<std::string>(value),
                                  {{{"lazy", Update::lazy}, {"full", Update::full}, {"automatic", Update::automatic}}});
        else if (name == "kdop" && of_collider)
            out.kdop = kdop_of(py::cast<int>(value));
        else if (name == "keep_cut" && of_collider)
            out.keep_cut = py::cast<bool>(value);
        else if (name == "lanes" && of_collider)
            out.lanes = py::cast<std::size_t>(value);
        else
            throw py::type_error(
                "there is no option '" + name + "'; known are method, precision, rest_shape, update" +
                (of_collider ? ", kdop, keep_cut, lanes" : "; kdop, keep_cut and lanes are the collider's"));
    }
    if (out.lanes != 4 && out.lanes != 8 && out.lanes != 16)
        throw py::value_error("lanes are 4, 8 or 16");
    return out;
}

template <class F> auto unlocked(F&& f)
{
    const py::gil_scoped_release released;
    return f();
}

class ColliderObject {
public:
    explicit ColliderObject(const py::kwargs& options) : options_(lazy_options({}, options, true)), collider_(options_)
    {
    }

    BodyId add(py::handle of, py::handle targets, const py::kwargs& own)
    {
        const Busy busy(busy_, "Collider");
        Body body;
        BodyId id;
        const LazyOptions how = lazy_options(options_, own, false);
        if (py::isinstance<Tree>(of)) {
            body.tree = needed<Tree>(of, "body");
            body.surface = body.tree->surface;
        } else {
            body.surface = needed<Surface>(of, "body");
        }
        body.surface->require_unchanged();
        const DeformableSurface& surface = body.surface->get();
        body.targets = std::make_unique<std::vector<MorphTarget>>(targets_from(targets, surface.mesh.vertices.size()));
        if (!body.targets->empty()) {
            if (body.tree || py::len(own) > 0)
                throw py::value_error("Collider.add: morph targets go with a surface and the collider's own options");
            id = unlocked([&] { return collider_.add(surface, *body.targets); });
        } else if (body.tree) {
            id = unlocked([&] { return collider_.add(body.tree->bvh, surface, how); });
        } else {
            id = unlocked([&] { return collider_.add(surface, how); });
        }
        bodies_.emplace(id, std::move(body));
        return id;
    }

    void remove(BodyId id)
    {
        const Busy busy(busy_, "Collider");
        collider_.remove(id);
        bodies_.erase(id);
    }

    std::vector<BodyId> bodies()
    {
        const Busy busy(busy_, "Collider");
        const auto ids = collider_.bodies();
        return {ids.begin(), ids.end()};
    }

    // Everything is copied: queries read it until the next frame, whatever becomes of the arrays.
    void update(py::handle frames, py::handle positions, py::handle weights)
    {
        const Busy busy(busy_, "Collider");
        const auto ids = collider_.bodies();
        auto list = [&](py::handle from, const char* name) {
            py::list out;
            if (!from.is_none())
                for (const py::handle one : from)
                    out.append(one);
            if (!from.is_none() && out.size() != ids.size())
                throw py::value_error(std::string(name) + ": one per body is needed, of which there are " +
                                      std::to_string(ids.size()));
            return out;
        };
        const py::list maps = list(frames, "maps"), places = list(positions, "positions"),
                       morphs = list(weights, "weights");
        if (frames.is_none())
            throw py::value_error("maps: one per body is needed");
        std::vector<Moved> moved(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const Body& body = bodies_.at(ids[i]);
            body.surface->require_unchanged();
            const DeformableSurface& s = body.surface->get();
            const Doubles given(maps[i], "maps");
            require_shape(given.array(), "maps", {static_cast<py::ssize_t>(s.weights.node_count), 3, 4});
            const auto rows = given.rows<AffineMap>();
            moved[i].maps.assign(rows.begin(), rows.end());
            if (!positions.is_none() && !places[i].is_none()) {
                const Doubles place(places[i], "positions");
                require_shape(place.array(), "positions", {static_cast<py::ssize_t>(s.mesh.vertices.size()), 3});
                const auto at = place.rows<Vec3>();
                moved[i].positions.assign(at.begin(), at.end());
            }
            if (!weights.is_none() && !morphs[i].is_none()) {
                const Doubles all(morphs[i], "weights");
                require_shape(all.array(), "weights", {static_cast<py::ssize_t>(body.targets->size())});
                moved[i].weights.assign(all.values().begin(), all.values().end());
            }
        }
        moved_ = std::move(moved);
        std::vector<BodyFrame> all;
        for (const Moved& one : moved_)
            all.push_back({one.maps, one.positions, one.weights});
        unlocked([&] { collider_.update(all); });
    }

    py::array_t<std::uint32_t> find(Query query)
    {
        const Busy busy(busy_, "Collider");
        std::vector<TrianglePair> all;
        Ticker tick;
        unlocked([&] {
            collider_.find(query, [&](std::span<const TrianglePair> some) {
                all.insert(all.end(), some.begin(), some.end());
                tick(0, 1);
                return true;
            });
        });
        return rows_of<TrianglePair>(all);
    }

    bool each(py::handle sink)
    {
        const Busy busy(busy_, "Collider");
        return unlocked([&] {
            return collider_.find(Query::pairs, [&](std::span<const TrianglePair> some) {
                const py::gil_scoped_acquire locked;
                const py::object answer = sink(rows_of(some));
                return answer.is_none() || py::cast<bool>(answer);
            });
        });
    }

    bool any_pair()
    {
        const Busy busy(busy_, "Collider");
        return unlocked([&] { return collider_.any(); });
    }

    void set_filter(py::object wanted)
    {
        const Busy busy(busy_, "Collider");
        if (wanted.is_none()) {
            collider_.set_filter({});
            return;
        }
        if (!PyCallable_Check(wanted.ptr()))
            throw py::type_error("set_filter: a callable or None is needed");
        collider_.set_filter([ask = held(std::move(wanted))](BodyId a, BodyId b) {
            const py::gil_scoped_acquire locked;
            return py::cast<bool>((*ask)(a, b));
        });
    }

    std::vector<BodyId> unknown()
    {
        const Busy busy(busy_, "Collider");
        return collider_.unknown();
    }
    QueryCounts counts()
    {
        const Busy busy(busy_, "Collider");
        return collider_.counts();
    }
    std::size_t bytes()
    {
        const Busy busy(busy_, "Collider");
        return collider_.bytes();
    }

private:
    struct Body {
        TreePtr tree;
        SurfacePtr surface;
        std::unique_ptr<std::vector<MorphTarget>> targets; // which stay where they are
    };
    struct Moved {
        std::vector<AffineMap> maps;
        std::vector<Vec3> positions;
        std::vector<double> weights;
    };

    std::atomic<bool> busy_{false};
    LazyOptions options_;
    std::map<BodyId, Body> bodies_;
    std::vector<Moved> moved_; // the frame's
    Collider collider_;        // refers to both
};

void add_counts(py::module_& module)
{
    py::class_<QueryCounts>(module, "QueryCounts", "What the queries of a frame did.")
        .def_readonly("body_pairs", &QueryCounts::body_pairs, "Whose roots overlap.")
        .def_readonly("box_tests", &QueryCounts::box_tests, "Pairs of BVs.")
        .def_readonly("leaf_pairs", &QueryCounts::leaf_pairs, "Whose k-DOPs overlap.")
        .def_readonly("triangle_tests", &QueryCounts::triangle_tests, "Pairs of triangles whose boxes overlap.")
        .def_readonly("in_double", &QueryCounts::in_double, "Of these, decided in doubles with filtered signs;")
        .def_readonly("in_exact", &QueryCounts::in_exact, "by exact arithmetic; all others by floats with margins.")
        .def_property_readonly(
            "bounds", [](const QueryCounts& self) { return self.updates.bounds; }, "BVs bounded by the methods.")
        .def_property_readonly(
            "leaves", [](const QueryCounts& self) { return self.updates.leaves; }, "Leaves that were deformed.")
        .def_property_readonly(
            "vertices", [](const QueryCounts& self) { return self.updates.vertices; }, "Of these leaves.")
        .def_property_readonly(
            "merged", [](const QueryCounts& self) { return self.updates.merged; }, "BVs bounded by their children.");
}

} // namespace

void add_collider(py::module_& module)
{
    add_counts(module);
    py::class_<ColliderObject>(module, "Collider",
                               R"(The intersecting triangles of several deforming bodies, exactly, frame after frame.

A pair is one if the closed triangles whose vertices are those of `evaluate` have a point in common. The list and its
order are the same for every method, k, history and number of threads.

Parameters
----------
method, kdop, precision, rest_shape : optional
    As of `Refitter`.
update : {'automatic', 'lazy', 'full'}, optional
    How much of a tree a frame brings up to date.
keep_cut : bool, optional
    False: every BV by the methods when it is wanted.
lanes : {16, 8, 4}, optional
    Room for the triangles and vertices of every leaf.

Examples
--------
>>> collider = cinch.Collider()
>>> left, right = collider.add(surface), collider.add(surface)
>>> collider.update([maps, moved])
>>> collider.pairs()   # (n, 4): body, triangle, body, triangle
)")
        .def(py::init<const py::kwargs&>())
        .def("add", &ColliderObject::add, py::arg("body"), py::arg("targets") = py::tuple(), R"(Add a body.

Queries need a new update then.

Parameters
----------
body : Surface or Bvh
    A BVH must have leaves of at most `lanes` triangles and vertices.
targets : list of MorphTarget, optional
    That displace it; of a surface only.
**options
    Its own method, precision, rest_shape and update.

Returns
-------
int
    Its id: 0, 1, 2, ..., never given twice.
)")
        .def("remove", &ColliderObject::remove, py::arg("body"), "Take a body away; the others keep their ids.")
        .def_property_readonly("bodies", &ColliderObject::bodies, "Ids, ascending: a list of int.")
        .def("set_filter", &ColliderObject::set_filter, py::arg("wanted"),
             "Leave out the pairs of bodies a < b for which ``wanted(a, b)`` is false. None: leave out none.")
        .def("update", &ColliderObject::update, py::arg("maps"), py::kw_only(), py::arg("positions") = py::none(),
             py::arg("weights") = py::none(), R"(Begin a frame. Everything is copied.

Parameters
----------
maps : list of array_like, shape (J, 3, 4)
    Per body, in the order of `bodies`.
positions : list of array_like, shape (V, 3), or None; optional
    Of all vertices, where they are there anyway: then these are the vertices.
weights : list of array_like, shape (targets,), or None; optional
    Of morph targets.
)")
        .def(
            "pairs", [](ColliderObject& self) { return self.find(Query::pairs); },
            R"(All intersecting pairs of the frame.

Returns
-------
numpy.ndarray of uint32, shape (n, 4)
    body a, its triangle, body b, its triangle; a < b.
)")
        .def(
            "leaves", [](ColliderObject& self) { return self.find(Query::leaves); },
            "Pairs of leaves whose k-DOPs overlap, each given by its first triangle: as `pairs`, no triangle is "
            "tested.")
        .def("any", &ColliderObject::any_pair, "Whether there is a pair; stops at the first.")
        .def("find", &ColliderObject::each, py::arg("sink"), R"(All pairs, piece by piece.

Parameters
----------
sink : callable
    Called with arrays as of `pairs`; False ends the query.

Returns
-------
bool
    Whether there is a pair.
)")
        .def_property_readonly("unknown", &ColliderObject::unknown, R"(Bodies of which nothing is known in this frame.

A transform that has weight is not finite, or too large. They overlap everything, and are in no pair.)")
        .def_property_readonly("counts", &ColliderObject::counts, "`QueryCounts` of the frame so far.")
        .def_property_readonly("nbytes", &ColliderObject::bytes, "Of all but surfaces and BVHs that were given.");
}

} // namespace cinch::python
