// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <catch2/catch.hpp>

#include "tests/collide/pair_cases.hpp"
#include "tests/support.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

void check(const TrianglePoints& a, const TrianglePoints& b, bool expected)
{
    if (const int wrong = wrong_orders(a, b, expected))
        FAIL_CHECK(wrong << " of 72 orders are wrong, " << (expected ? "intersecting: " : "disjoint: ") << text(a, b));
}

TrianglePoints triangle(const Vec3& a, const Vec3& b, const Vec3& c) { return {a, b, c}; }

} // namespace

TEST_CASE("triangle pairs agree with an exact clipper in every order: random small integers")
{
    std::mt19937_64 random(1);
    std::array<int, 2> answers{};
    const auto cases = static_cast<int>(share_of(1000000));
    for (int i = 0; i < cases; ++i) {
        const int greatest = std::array{2, 4, 10}[static_cast<std::size_t>(i % 3)];
        const SmallTriangle a = random_triangle(random, greatest), b = random_triangle(random, greatest);
        const bool expected = Clipper<Int128>::intersect(integers(a), integers(b));
        ++answers[expected];
        check(doubles(a), doubles(b), expected);
    }
    CHECK(answers[0] > cases / 4);
    CHECK(answers[1] > cases / 4);
}

TEST_CASE("triangle pairs agree with an exact clipper in every order: points, segments and coplanar triangles")
{
    std::mt19937_64 random(2);
    std::array<std::array<std::array<int, 2>, 7>, 7> answers{};
    const auto cases = static_cast<int>(share_of(110000));
    for (int i = 0; i < cases; ++i) {
        const int how_a = 1 + i % 6, how_b = 1 + i / 6 % 6, greatest = 1 + i / 36 % 3;
        const SmallTriangle a = collapse(random_triangle(random, greatest), how_a),
                            b = collapse(random_triangle(random, greatest), how_b);
        const bool expected = Clipper<Int128>::intersect(integers(a), integers(b));
        ++answers[static_cast<std::size_t>(how_a)][static_cast<std::size_t>(how_b)][expected];
        check(doubles(a), doubles(b), expected);
    }
    for (std::size_t how_a = 1; how_a < 7; ++how_a)
        for (std::size_t how_b = 1; how_b < 7; ++how_b) {
            INFO(how_a << " " << how_b);
            CHECK(answers[how_a][how_b][0] >= 50 * cases / 110000);
            CHECK(answers[how_a][how_b][1] >= 20 * cases / 110000);
        }
}

TEST_CASE("touching triangles intersect: a common vertex, edge, and the same triangle")
{
    const Vec3 o(0.1, 0.2, 0.3), x(1.1, 0.7, -0.4), y(0.3, 1.9, 0.2), z(0.7, 0.1, 1.3), w(-0.9, 0.3, 5.1);
    check(triangle(o, x, y), triangle(o, x, y), true);
    check(triangle(o, x, y), triangle(o, x, z), true);
    check(triangle(o, x, y), triangle(o, z, w), true);
    check(triangle(o, x, y), triangle(x, y, x + y - o), true);
    check(triangle(o, o, o), triangle(o, z, w), true);
    check(triangle(o, x, x), triangle(y, z, o), true);
    check(triangle(o, o, o), triangle(z, z, z), false);
    // The centroid of a's edge in the interior of b, exactly.
    check(triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), triangle({0.5, 0.5, 0}, {0.5, 0.5, 1}, {1, 0.5, 1}), true);
    check(triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), triangle({0.5, 0.5, 0x1p-1074}, {0.5, 0.5, 1}, {1, 0.5, 1}),
          false);
    check(triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), triangle({1, 1, 0}, {2, 1, 3}, {2, 2, -4}), true);
    check(triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), triangle({1 + 0x1p-52, 1, 0}, {2, 1, 3}, {2, 2, -4}), false);
}

TEST_CASE("triangle pairs on which other programs fail")
{
    // libigl #2381: a triangle subdivided twice; triangles without a common vertex do not meet.
    const std::vector<Vec3> v{{0.280039012432098, 0.82766300439834595, 0.46377500891685502},
                              {0.33890101313590998, 0.78804200887680098, 0.48812699317932101},
                              {0.31805300712585399, 0.76836401224136397, 0.49308800697326699},
                              {0.30947001278400399, 0.80785250663757346, 0.47595100104808802},
                              {0.299046009778976, 0.79801350831985496, 0.47843150794506101},
                              {0.32847701013088199, 0.77820301055908248, 0.490607500076294},
                              {0.29475451260805097, 0.81775775551795971, 0.46986300498247152},
                              {0.28954251110553697, 0.81283825635910045, 0.47110325843095802},
                              {0.32418551295995701, 0.79794725775718722, 0.48203899711370451},
                              {0.33368901163339598, 0.78312250971794173, 0.48936724662780751},
                              {0.30854950845241502, 0.78318876028060946, 0.485759757459164},
                              {0.32326500862836799, 0.77328351140022322, 0.4918477535247805},
                              {0.30425801128148999, 0.80293300747871421, 0.47719125449657451},
                              {0.31897351145744302, 0.79302775859832797, 0.48327925056219101},
                              {0.31376150995492902, 0.78810825943946872, 0.4845195040106775}};
    const std::vector<std::array<std::size_t, 3>> f{
        {2, 11, 10}, {1, 8, 9},  {0, 7, 6},  {3, 12, 13}, {5, 14, 11},  {3, 13, 8}, {4, 12, 7}, {4, 14, 12},
        {4, 10, 14}, {5, 9, 13}, {3, 6, 12}, {5, 13, 14}, {14, 10, 11}, {13, 9, 8}, {12, 6, 7}, {14, 13, 12}};
    for (std::size_t i = 0; i < f.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const TrianglePoints a = triangle(v[f[i][0]], v[f[i][1]], v[f[i][2]]),
                                 b = triangle(v[f[j][0]], v[f[j][1]], v[f[j][2]]);
            const bool share = std::find_first_of(f[i].begin(), f[i].end(), f[j].begin(), f[j].end()) != f[i].end();
            CHECK(exact_intersect(a, b) == share);
            check(a, b, share);
        }
    struct Known {
        TrianglePoints a, b;
        bool expected;
    };
    const Known known[] = {
        // libigl #2382, nearly coplanar and apart
        {{{{0.39234799146652199, 0.38443601131439198, 0.44744500517845198},
           {0.39079749584197976, 0.38503675907850249, 0.45253425091505073},
           {0.38700349628925301, 0.38789276033639897, 0.45634675025939975}}},
         {{{0.38924700021743752, 0.385637506842613, 0.45762349665164948},
           {0.39279749989509577, 0.37299175560474374, 0.45553924888372399},
           {0.38769650459289529, 0.38623825460672351, 0.46271274238824822}}},
         false},
        // axom #152, coplanar, a vertex of b on one of a
        {{{{76.648, 54.6752, 15.0012}, {76.648, 54.6752, 14.5542}, {76.582, 54.6752, 14.7879}}},
         {{{76.6252, 54.6752, 14.892}, {76.582, 54.6752, 14.7879}, {76.5617, 54.6752, 14.7929}}},
         true},
        // benardp/contours #1
        {{{{12.3015, -0.253368, 5.49101}, {18.6765, -2.55337, 4.91756}, {12.3015, -2.55337, 4.91756}}},
         {{{-11.9885, -0.253368, 5.49101}, {1.61448, -0.253368, 5.49101}, {1.61448, -2.55337, 4.91756}}},
         false},
        // CGAL #3715, coplanar with a common edge
        {{{{35.404636216406281, -24.862331251811071, 0},
           {38.23198196838576, -20.523160779735431, 0},
           {38.260998625669473, -20.377626078374075, 0}}},
         {{{35.315294952344537, -25.009813099560063, 0},
           {38.23198196838576, -20.523160779735431, 0},
           {35.404636216406281, -24.862331251811071, 0}}},
         true},
        // CGAL #2319, a vertex on a face
        {{{{0.045769477844238279, 0.07539492797851563, 0.013735383987426759},
           {0.036645412445068359, 0.060013595581054686, 0.013735383987426759},
           {0.049645965576171874, 0.050098735809326174, 0.013735383987426759}}},
         {{{0.044114555358886719, 0.066831237792968748, 0.013735383987426759},
           {0.044415161132812499, 0.066367233276367191, 0.014259093284606934},
           {0.044114555358886719, 0.066307533264160154, 0.014259093284606934}}},
         true},
        // CGAL #6384
        {{{{-1.22511, -5.88997, -7.98795}, {0.404908, -6.00145, -3.31432}, {-1.22511, -5.88997, -3.31432}}},
         {{{-0.212431, -5.7414293, -4.503795}, {-0.152387, -6.0416265, -4.516812}, {-0.567143, -5.9451375, -4.378002}}},
         true},
        // geogram #10
        {{{{1898.68, 775, 1158.48}, {2000, 775, 1166.7}, {1898.68, 675, 1148.6}}},
         {{{1966.41, 675, 1163.79}, {1971.63, 675, 1166.95}, {1967.56, 684.554, 1166.67}}},
         false},
        // jgt-code #10, a common edge
        {{{{-200, -7.661661997582373651027865, 110.7006972331142975463081},
           {-200, -15.32332399516475796019677, 121.4013944662285808817614},
           {-200, -10.41705198583709623960658, 122.1265882878931563482183}}},
         {{{-200, -15.32332399516475796019677, 121.4013944662285808817614},
           {-200.0147534839701108921872, -5.208525992918542790732772, 111.0632941439465781741092},
           {-200, -10.41705198583709623960658, 122.1265882878931563482183}}},
         true}};
    for (const Known& k : known) {
        CHECK(exact_intersect(k.a, k.b) == k.expected);
        check(k.a, k.b, k.expected);
    }

    // The wall of jgt-code #9, and others that stand on the line of its second corner.
    const TrianglePoints wall{{{22.3743700520433002, 29.5499517077955005, 0.699999992258483972},
                               {22.3554557937079998, 29.5919729814260997, 0.600000003652259029},
                               {22.3743700520433002, 29.5499517077955005, 0.600000003652259029}}};
    std::size_t apart = 0;
    for (const double low : {0.3, 0.600000003652259029, 0.65, 0.699999992258483972, 0.800000012016313988})
        for (const double high : {0.599999, 0.7, 0.9})
            for (const double x : {-0.02, -0.0189142583353004, 0.0, 0.0189142583353004, 0.02})
                for (const double y : {-0.0420212736305992, 0.0, 0.0420212736305992, 0.05}) {
                    const TrianglePoints other{{{wall[1][0], wall[1][1], low},
                                                {wall[1][0], wall[1][1], high},
                                                {wall[1][0] + x, wall[1][1] + y, 0.800000012016313988}}};
                    const bool expected = exact_intersect(wall, other);
                    apart += !expected;
                    check(wall, other, expected);
                }
    CHECK((apart > 50 && apart < 290));
}

TEST_CASE("a coordinate that is not finite is taken to intersect")
{
    const SmallTriangle a{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, b{{{9, 9, 9}, {8, 9, 9}, {9, 8, 9}}};
    check(doubles(a), doubles(b), false);
    using limits = std::numeric_limits<double>;
    for (double unknown : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()})
        for (std::size_t vertex = 0; vertex < 3; ++vertex)
            for (Eigen::Index axis = 0; axis < 3; ++axis) {
                TrianglePoints t = doubles(b);
                t[vertex][axis] = unknown;
                check(doubles(a), t, true);
            }
}
