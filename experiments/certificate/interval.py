# SPDX-License-Identifier: GPL-3.0-or-later
"""Intervals of real numbers as middle and radius, whole numbers of 2^-BITS; every operation encloses the exact one."""
import math

BITS = 160
UNIT = 1 << BITS


class Interval:
    __slots__ = ("mid", "rad")

    def __init__(self, mid, rad=0):
        self.mid, self.rad = mid, rad

    def __add__(self, other):
        return Interval(self.mid + other.mid, self.rad + other.rad)

    def __sub__(self, other):
        return Interval(self.mid - other.mid, self.rad + other.rad)

    def __neg__(self):
        return Interval(-self.mid, self.rad)

    def __mul__(self, other):
        rad = abs(self.mid) * other.rad + self.rad * (abs(other.mid) + other.rad)
        return Interval((self.mid * other.mid) >> BITS, (rad >> BITS) + 2)

    def times(self, whole):
        return Interval(self.mid * whole, self.rad * abs(whole))

    def over(self, whole):
        """Divided by a whole number > 0."""
        return Interval(self.mid // whole, self.rad // whole + 2)

    def __truediv__(self, other):
        """By what is positive as a whole; ZeroDivisionError where it may not be."""
        low = other.mid - other.rad
        if low <= 0:
            raise ZeroDivisionError
        # |x/y - m/n| <= (|x - m| + |m/n| |y - n|)/|y|
        ratio = (self.mid << BITS) // other.mid
        return Interval(ratio, ((self.rad << BITS) + (abs(ratio) + 1) * other.rad) // low + 2)

    def square(self):
        low = max(abs(self.mid) - self.rad, 0)
        return between(low * low >> BITS, ((abs(self.mid) + self.rad) ** 2 >> BITS) + 1)

    def low(self):
        return self.mid - self.rad

    def high(self):
        return self.mid + self.rad


ZERO, ONE = Interval(0), Interval(UNIT)


def between(low, high):
    mid = (low + high) // 2
    return Interval(mid, high - mid)


def hull(values):
    return between(min(x.low() for x in values), max(x.high() for x in values))


def of_double(x):
    p, q = x.as_integer_ratio()
    return of_ratio(p, q)


def of_ratio(p, q):
    """p/q, q > 0."""
    mid, rest = divmod(p << BITS, q)
    return Interval(mid, 1 if rest else 0)


def root(x):
    """Of what is not negative but for its radius."""
    low, high = max(x.low(), 0), max(x.high(), 0)
    return between(math.isqrt(low << BITS), math.isqrt(high << BITS) + 1)


def arc_tangent_of_quarter(y, x):
    """atan2(y, x) for x, y >= 0, not both 0. Three times the tangent is made that of half the angle,
    t/(1 + sqrt(1 + t^2)), to at most tan(pi/16) < 0.2; then atan's series, which alternates and falls."""
    size = root(x.square() + y.square())
    t = y / (size + x)  # of half the angle, at most 1
    for _ in range(2):
        t = t / (ONE + root(ONE + t.square()))
    square, power, total, n = t.square(), t, ZERO, 1
    while power.high() > n:  # of the least unit
        total = total - power.over(n) if n % 4 == 3 else total + power.over(n)
        power = power * square
        n += 2
    return (total + Interval(0, power.high() // n + 1)).times(8)


def sine_and_cosine(x):
    """At x, 0 <= x <= 4 but for rounding. Taylor's series at x/64, which alternate and fall, and six double angles.

    In the least unit: a term is off by 2 and at most a tenth of what the one before it is off by, so forty sums by less
    than 90; the rest is below 3. x/64 is off by 1. An angle doubled is off by at most 4 e + 3 (2 (s e + c e) + 2, 4 s e
    + 2), so after six times by less than 4^6 96 < 2^19; x's own radius comes on top, and 64 for that of x/64."""
    y, term, sums, n = x.mid >> 6, UNIT, [0, 0], 0
    while abs(term) > 1:
        sums[n & 1] += -term if n & 2 else term
        n += 1
        term = (term * y >> BITS) // n
        if n > 40:
            raise ZeroDivisionError  # an angle of which nothing is known
    cosine, sine = sums
    for _ in range(6):
        sine, cosine = sine * cosine >> (BITS - 1), UNIT - (sine * sine >> (BITS - 1))
    rad = (1 << 19) + 64 + x.rad
    return Interval(sine, rad), Interval(cosine, rad)


HALF_TURN = arc_tangent_of_quarter(ONE, ZERO).times(2)


def sine_and_cosine_between(first, last, ends):
    """On [first, last], 0 <= first <= last <= pi but for rounding: the cosine falls, the sine has its top at pi/2.
    `ends`: sine_and_cosine of both."""
    sine, cosine = (hull([end[i] for end in ends]) for i in (0, 1))
    slack = first.rad + last.rad
    if first.low() <= HALF_TURN.high() // 2 + 1 and last.high() >= HALF_TURN.low() // 2 - 1:
        sine = between(sine.low(), UNIT)
    if last.high() >= HALF_TURN.low():
        cosine = between(-UNIT, cosine.high())
    if first.low() <= 0:
        cosine = between(cosine.low(), UNIT)
    return Interval(sine.mid, sine.rad + slack), Interval(cosine.mid, cosine.rad + slack)
