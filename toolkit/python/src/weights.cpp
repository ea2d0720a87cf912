// SPDX-License-Identifier: Apache-2.0
#include "toolkit/python/src/weights.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "toolkit/python/src/needed.hpp"

namespace cinch::python {
namespace {

constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();

std::string vertex_text(std::size_t vertex) { return "weights: vertex " + std::to_string(vertex); }

// What is no weight of anybody, normalised or not.
void require_weight(double w, std::size_t vertex)
{
    if (!(std::isfinite(w) && w >= 0))
        throw py::value_error(vertex_text(vertex) + " has " + std::to_string(w) +
                              "; finite weights from 0 on are needed");
}

Influences from_dense(const Doubles& dense)
{
    if (dense.ndim() != 2)
        throw py::value_error("weights: an array of shape (vertices, simulation nodes) is needed, not " +
                              shape_of(dense.array()));
    const std::size_t vertices = dense.shape(0), nodes = dense.shape(1);
    if (nodes >= most)
        throw py::value_error("weights: over 2^32 simulation nodes");
    Influences out;
    out.node_count = static_cast<std::uint32_t>(nodes);
    const auto values = dense.values();
    for (std::size_t k = 0; k < vertices; ++k) {
        for (std::size_t j = 0; j < nodes; ++j) {
            const double w = values[k * nodes + j];
            require_weight(w, k);
            if (w == 0)
                continue;
            out.node.push_back(static_cast<std::uint32_t>(j));
            out.weight.push_back(w);
        }
        if (out.node.size() >= most)
            throw py::value_error("weights: over 2^32 that are not 0");
        out.row.push_back(static_cast<std::uint32_t>(out.node.size()));
    }
    return out;
}

Influences from_triplets(py::handle data, py::handle columns, py::handle starts, py::handle nodes)
{
    const Doubles weight(data, "weights.data");
    require_shape(weight.array(), "weights.data", {any});
    if (weight.size() >= most)
        throw py::value_error("weights: over 2^32 of them");
    const py::array column_array = as_array(columns, "weights.indices"),
                    start_array = as_array(starts, "weights.indptr");
    require_shape(column_array, "weights.indices", {static_cast<py::ssize_t>(weight.size())});
    require_shape(start_array, "weights.indptr", {any});
    std::uint64_t count = most;
    if (!nodes.is_none()) {
        if (!py::isinstance<py::int_>(nodes) && !PyIndex_Check(nodes.ptr()))
            throw py::type_error("nodes: a whole number is needed");
        const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(nodes.ptr()));
        if (!index)
            throw py::error_already_set();
        const auto given = py::cast<long long>(index);
        if (given < 0 || static_cast<std::uint64_t>(given) >= most)
            throw py::value_error("nodes: from 0 to below 2^32 are needed");
        count = static_cast<std::uint64_t>(given);
    }
    const std::vector<std::uint32_t> node = indices(column_array, "weights.indices", count);
    const std::vector<std::uint32_t> row = indices(start_array, "weights.indptr", weight.size() + 1);
    if (row.empty() || row.front() != 0 || row.back() != weight.size() || !std::is_sorted(row.begin(), row.end()))
        throw py::value_error("weights.indptr: from 0 to the number of weights, ascending, is needed");
    if (nodes.is_none()) {
        count = 0;
        for (const std::uint32_t j : node)
            count = std::max<std::uint64_t>(count, j + 1);
    }
    Influences out;
    out.node_count = static_cast<std::uint32_t>(count);
    std::vector<std::uint32_t> order;
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
        order.resize(row[k + 1] - row[k]);
        std::iota(order.begin(), order.end(), row[k]);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return node[a] < node[b]; });
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i > 0 && node[order[i]] == node[order[i - 1]])
                throw py::value_error(vertex_text(k) + " has simulation node " + std::to_string(node[order[i]]) +
                                      " twice");
            require_weight(weight.values()[order[i]], k);
            out.node.push_back(node[order[i]]);
            out.weight.push_back(weight.values()[order[i]]);
        }
        out.row.push_back(static_cast<std::uint32_t>(out.node.size()));
    }
    return out;
}

// SciPy's CSR arrays, and all that can be made one.
bool is_sparse(py::handle from) { return py::hasattr(from, "tocsr") || py::hasattr(from, "indptr"); }

Influences from_sparse(py::handle from)
{
    const py::object csr = py::hasattr(from, "tocsr") ? from.attr("tocsr")() : py::reinterpret_borrow<py::object>(from);
    for (const char* part : {"data", "indices", "indptr", "shape"})
        if (!py::hasattr(csr, part))
            throw py::value_error(std::string("weights: a sparse array has ") + part);
    const py::object shape = csr.attr("shape");
    if (!py::isinstance<py::tuple>(shape) || py::len(shape) != 2)
        throw py::value_error("weights: a sparse array of two dimensions is needed");
    const py::object columns = py::reinterpret_borrow<py::tuple>(shape)[1];
    Influences out = from_triplets(csr.attr("data"), csr.attr("indices"), csr.attr("indptr"), columns);
    return out;
}

// Sums as far from 1 as those that a program made in binary32.
void require_convex(const Influences& influences)
{
    for (std::size_t k = 0; k + 1 < influences.row.size(); ++k) {
        const auto first = influences.weight.begin() + influences.row[k],
                   last = influences.weight.begin() + influences.row[k + 1];
        const double sum = std::accumulate(first, last, 0.0);
        if (!(std::abs(sum - 1) <= sum_rounding(static_cast<std::size_t>(last - first))))
            throw py::value_error(vertex_text(k) + ": the sum is " + std::to_string(sum) +
                                  ", not 1; normalise=True divides by it");
    }
}

py::array_t<double> dense_of(const Weights& weights)
{
    const std::size_t vertices = weights.vertex_count(), nodes = weights.node_count;
    py::array_t<double> out(
        std::vector<py::ssize_t>{static_cast<py::ssize_t>(vertices), static_cast<py::ssize_t>(nodes)});
    double* const to = out.mutable_data();
    std::fill_n(to, vertices * nodes, 0.0);
    for (std::size_t k = 0; k < vertices; ++k)
        for (std::uint32_t e = weights.row[k]; e < weights.row[k + 1]; ++e)
            to[k * nodes + weights.node[e]] = weights.weight[e];
    return out;
}

} // namespace

WeightsObject weights_from(py::handle from, py::handle nodes, bool normalise)
{
    Influences influences;
    if (py::isinstance<py::tuple>(from) && py::len(from) == 3) {
        const auto parts = py::reinterpret_borrow<py::tuple>(from);
        influences = from_triplets(parts[0], parts[1], parts[2], nodes);
    } else if (!py::isinstance<py::array>(from) && is_sparse(from)) {
        influences = from_sparse(from);
    } else {
        influences = from_dense(Doubles(from, "weights"));
    }
    if (!normalise)
        require_convex(influences);
    WeightsObject out;
    for (std::size_t k = 0; k + 1 < influences.row.size(); ++k) {
        double sum = 0; // one that overflows is none to divide by
        for (std::uint32_t e = influences.row[k]; e < influences.row[k + 1]; ++e)
            sum += influences.weight[e];
        if (!std::isfinite(sum))
            throw py::value_error(vertex_text(k) + ": the sum overflows");
    }
    out.weights = to_dyadic(influences, &out.report);
    return out;
}

void add_weights(py::module_& module)
{
    py::class_<WeightReport>(module, "WeightReport", R"(What normalising weights changed.

Dividing by their sum s changes every weight of a vertex by the share ``abs(1/s - 1)``.
)")
        .def_readonly("vertices", &WeightReport::vertices, "All of them.")
        .def_readonly("normalised", &WeightReport::normalised,
                      "Vertices whose weights it changed by more than rounding in binary32 explains.")
        .def_readonly("beyond_steps", &WeightReport::beyond_steps,
                      "Of these, whose sum is off by more than storing weights as integers explains.")
        .def_readonly("largest_change", &WeightReport::largest_change,
                      "Share by which it changed weights of these vertices at most.")
        .def_readonly("without_weight", &WeightReport::without_weight,
                      "Vertices whose weights were all 0: bound wholly to the first simulation node they name.")
        .def_readonly("least_sum", &WeightReport::least_sum, "Of the weights of one vertex.")
        .def_readonly("greatest_sum", &WeightReport::greatest_sum, "Of the weights of one vertex.");

    using Self = Needed<WeightsObject>;
    py::class_<WeightsObject, std::shared_ptr<WeightsObject>>(
        module, "Weights", R"(Convex weights of every vertex: how simulation nodes move it.

Stored as multiples of 2**-53 that sum to exactly 1, ascending in simulation node, without zeros.

Parameters
----------
weights : array_like of shape (V, J), (data, indices, indptr), or a SciPy sparse array
    Dense, or as compressed sparse rows: vertex k has the weights ``data[indptr[k]:indptr[k + 1]]`` of the simulation
    nodes ``indices[...]``, in any order, none twice.
nodes : int, optional
    J, where triplets are given; else one more than their greatest index.
normalise : bool, optional
    Divide the weights of each vertex by their sum. Otherwise sums must be 1, but for rounding in binary32.

Raises
------
ValueError
    For weights that are negative, no numbers, or, without `normalise`, not convex; for indices out of range.
)")
        .def(py::init(&weights_from), py::arg("weights"), py::kw_only(), py::arg("nodes") = py::none(),
             py::arg("normalise") = false)
        .def_property_readonly(
            "data", [](const Self& self) { return py::object(triplets(self->weights, py::cast(self))[0]); },
            "Weights, vertex by vertex. Cannot be written.")
        .def_property_readonly(
            "indices", [](const Self& self) { return py::object(triplets(self->weights, py::cast(self))[1]); },
            "Their simulation nodes, uint32. Cannot be written.")
        .def_property_readonly(
            "indptr", [](const Self& self) { return py::object(triplets(self->weights, py::cast(self))[2]); },
            "Where vertices begin, uint32, shape (V + 1,). Cannot be written.")
        .def_property_readonly(
            "shape",
            [](const WeightsObject& self) {
                return py::make_tuple(self.weights.vertex_count(), self.weights.node_count);
            },
            "(V, J).")
        .def_property_readonly(
            "report", [](const WeightsObject& self) { return self.report; },
            "A `WeightReport`: what normalising changed.")
        .def_readonly("alone", &WeightsObject::alone,
                      "Of `kernel_weights`: vertices beyond the reach of every simulation node.")
        .def(
            "toarray", [](const WeightsObject& self) { return dense_of(self.weights); },
            R"(As a dense array.

Returns
-------
numpy.ndarray, shape (V, J)
)")
        .def("__len__", [](const WeightsObject& self) { return self.weights.vertex_count(); })
        .def("__repr__", [](const WeightsObject& self) {
            return "<cinch.Weights: " + std::to_string(self.weights.vertex_count()) + " vertices, " +
                   std::to_string(self.weights.node_count) + " simulation nodes>";
        });
}

} // namespace cinch::python
